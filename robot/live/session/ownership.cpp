#include "robot/live/session/ownership.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <grp.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

#include "drivers/digital_io/shared_io.hpp"
#include "drivers/needle_stage_factory.hpp"
#include "robot/common/config_error.hpp"
#include "robot/security/key_files.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;
using security::Role;

// Roles that are processes of the installed system.
constexpr std::array kProcessRoles{Role::Stage,    Role::Controller, Role::Supervisor,
                                   Role::Recorder, Role::Console,    Role::Navigation,
                                   Role::Observer, Role::Mcap,       Role::Confirmer};

std::string user_of(std::string_view process) {
  return fmt::format("biopsy-{}", process);
}

std::string owner_of_keys(const fs::path& folder) {
  for (const Role role : kProcessRoles)
    if (folder.filename() == name_of(role)) return user_of(name_of(role));
  return "root";
}

std::string owner_of_lines(digital_io::Owner owner, bool simulated) {
  if (owner != digital_io::Owner::Panel) return user_of(digital_io::name_of(owner));
  return user_of(simulated ? "console" : "stage");
}

std::vector<fs::path> sorted_content(const fs::path& folder) {
  std::vector<fs::path> content;
  for (const auto& entry : fs::directory_iterator(folder)) content.push_back(entry.path());
  std::sort(content.begin(), content.end());
  return content;
}

void add_tree(std::vector<Ownership>& files, const fs::path& path, const std::string& user,
              const std::string& group, mode_t folder_mode, mode_t file_mode) {
  if (fs::is_symlink(path)) return;  // what it leads to is listed where it lies
  const bool is_folder = fs::is_directory(path);
  files.push_back({path, user, group, is_folder ? folder_mode : file_mode});
  if (!is_folder) return;
  for (const fs::path& inner : sorted_content(path))
    add_tree(files, inner, user, group, folder_mode, file_mode);
}

[[noreturn]] void refuse(const std::string& problem, const fs::path& path, const std::string& remedy) {
  throw ConfigError(problem, path.string(), remedy);
}

constexpr const char* kMakeUsers = "make the users first: systemd-sysusers";

uid_t id_of_user(const Ownership& file) {
  const passwd* found = ::getpwnam(file.user.c_str());
  if (found == nullptr) refuse(fmt::format("there is no user {}", file.user), file.path, kMakeUsers);
  return found->pw_uid;
}

gid_t id_of_group(const Ownership& file) {
  const group* found = ::getgrnam(file.group.c_str());
  if (found == nullptr) refuse(fmt::format("there is no group {}", file.group), file.path, kMakeUsers);
  return found->gr_gid;
}

// Opened once, so that owner and mode are set of the same file.
void give(const Ownership& file) {
  const uid_t user = id_of_user(file);
  const gid_t group = id_of_group(file);
  const int opened = ::open(file.path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  const bool given = opened >= 0 && ::fchown(opened, user, group) == 0 && ::fchmod(opened, file.mode) == 0;
  const int error = errno;
  if (opened >= 0) ::close(opened);
  if (!given)
    refuse("cannot be given to its owner: " + std::generic_category().message(error), file.path,
           "start as root, in a folder that nobody else can write");
}

}  // namespace

std::vector<Ownership> ownership_of(const fs::path& run_folder, const live::LiveSettings& settings) {
  const std::string readers(kReadersGroup), io(kIoGroup);
  std::vector<Ownership> files{{run_folder, "root", readers, 0750}};
  for (const fs::path& path : sorted_content(run_folder))
    if (path != settings.keys) add_tree(files, path, "root", readers, 0750, 0640);
  if (!settings.keys.empty()) {
    files.push_back({settings.keys, "root", "root", 0711});
    for (const fs::path& role : sorted_content(settings.keys)) {
      const std::string user = owner_of_keys(role);
      add_tree(files, role, user, user, 0700, 0600);
    }
  }
  files.push_back({settings.lines, "root", "root", 0711});
  for (const digital_io::Owner owner : digital_io::kOwners)
    files.push_back({settings.lines / digital_io::name_of(owner),
                     owner_of_lines(owner, drivers::is_simulated(settings.device)), io, 0640});
  return files;
}

void give_to_owners(const std::vector<Ownership>& files) {
  for (const Ownership& file : files) give(file);
}

}  // namespace biopsy::robot
