#include "robot/common/files/atomic_directory.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <system_error>

#include "robot/common/config_error.hpp"

namespace biopsy {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& where, const std::string& what, int reason) {
  throw ConfigError(what + ": " + std::generic_category().message(reason), where.string(),
                    "name a folder that can be written, on a disk with free space; nothing was changed");
}

bool wrote_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t done = ::write(file, bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(done));
  }
  return true;
}

// Everything written below the folder is on the disk: one wait instead of one for each file.
bool on_disk(const fs::path& folder) {
  const int open_folder = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (open_folder < 0) return false;
  const bool done = ::syncfs(open_folder) == 0;
  ::close(open_folder);
  return done;
}

bool renamed(const fs::path& from, const fs::path& to) {
  return ::rename(from.c_str(), to.c_str()) == 0;
}

}  // namespace

AtomicDirectory::AtomicDirectory(const fs::path& destination)
    : destination_(fs::absolute(destination).lexically_normal()) {
  if (!destination_.has_filename()) destination_ = destination_.parent_path();  // it ended in a slash
  std::error_code trouble;
  fs::create_directories(destination_.parent_path(), trouble);
  if (trouble) refuse(destination_.parent_path(), "cannot be made", trouble.value());
  std::string pattern = destination_.string() + ".part-XXXXXX";
  if (::mkdtemp(pattern.data()) == nullptr)
    refuse(destination_.parent_path(), "cannot hold a new folder", errno);
  temporary_ = pattern;
}

AtomicDirectory::~AtomicDirectory() {
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
}

void AtomicDirectory::write(const fs::path& file, std::string_view bytes) {
  if (::mkdir(file.parent_path().c_str(), 0700) != 0 && errno != EEXIST)
    refuse(file.parent_path(), "cannot be made", errno);
  const int open_file = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (open_file < 0) refuse(file, "cannot be written", errno);
  const bool kept = wrote_all(open_file, bytes);
  const int reason = errno;
  ::close(open_file);
  if (!kept) refuse(file, "cannot be written", reason);
}

void AtomicDirectory::settle(const std::optional<fs::path>& aside) {
  if (!on_disk(temporary_)) refuse(temporary_, "cannot be written", errno);
  if (aside && !renamed(destination_, *aside)) refuse(destination_, "cannot be moved aside", errno);
  if (!renamed(temporary_, destination_)) {
    const int reason = errno;
    if (aside) renamed(*aside, destination_);
    refuse(destination_, "cannot be put in place", reason);
  }
  temporary_.clear();
  on_disk(destination_.parent_path());  // the new name as well; without it the old set is there again
}

}  // namespace biopsy
