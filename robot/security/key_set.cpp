#include "robot/security/key_set.hpp"

#include <fmt/format.h>

#include <system_error>

#include "robot/common/files/file.hpp"

namespace biopsy::security {
namespace {

namespace fs = std::filesystem;

// False as well without the right to look.
bool is_present(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

void check_same_ca(FileVerdict& verdict, const RoleFiles& first) {
  for (const fs::path& ca : {first.identity_ca, first.permissions_ca}) {
    if (!verdict.problem.empty() || verdict.file.filename() != ca.filename()) continue;
    if (read_file_if_present(verdict.file) == read_file_if_present(ca)) continue;
    verdict.problem =
        fmt::format("belongs to another set than {}", (ca.parent_path().filename() / ca.filename()).string());
    verdict.remedy =
        "copy the folders of all roles from one set, or make new keys: biopsy keys init --replace";
  }
}

}  // namespace

std::vector<Role> roles_present(const fs::path& folder) {
  std::vector<Role> present;
  for (const Role role : kRoles)
    if (is_present(folder / name_of(role))) present.push_back(role);
  return present;
}

std::vector<FileVerdict> inspect_set(const fs::path& folder, std::span<const Role> roles,
                                     std::chrono::sys_seconds now) {
  std::vector<FileVerdict> all;
  for (const Role role : roles) {
    for (FileVerdict& verdict : inspect_keys(folder, role, now)) {
      check_same_ca(verdict, role_files(folder, roles.front()));
      all.push_back(std::move(verdict));
    }
  }
  for (const Signer signer : kSigners) {
    if (!is_present(signing_files(folder, signer).private_key.parent_path())) continue;
    for (FileVerdict& verdict : inspect_signing_keys(folder, signer)) all.push_back(std::move(verdict));
  }
  return all;
}

void check_set(const fs::path& folder, std::span<const Role> roles, std::chrono::sys_seconds now) {
  throw_first_problem(inspect_set(folder, roles, now));
}

}  // namespace biopsy::security
