// biopsy keys: makes and looks through the identities and permissions of every process.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <system_error>
#include <vector>

#include "robot/cli/live_options.hpp"
#include "robot/common/sanitize_text.hpp"
#include "robot/security/key_files.hpp"
#include "robot/security/make_keys.hpp"
#include "robot/security/key_set.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;

std::chrono::sys_seconds now() {
  return std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::system_clock::now());
}

fs::path folder_of(const KeysOptions& options) {
  return options.folder.empty() ? security::default_folder() : options.folder;
}

void print_table(const std::vector<security::FileVerdict>& verdicts, const fs::path& folder) {
  std::size_t file_width = 4, subject_width = 7;
  std::vector<std::string> files, subjects;
  for (const security::FileVerdict& verdict : verdicts) {
    files.push_back(plain(verdict.file.lexically_relative(folder).string()));
    subjects.push_back(plain(verdict.subject));
    file_width = std::max(file_width, files.back().size());
    subject_width = std::max(subject_width, subjects.back().size());
  }
  fmt::print("{:<{}}  {:<{}}  {:<20}  verdict\n", "file", file_width, "subject", subject_width,
             "valid until");
  for (std::size_t i = 0; i < verdicts.size(); ++i)
    fmt::print("{:<{}}  {:<{}}  {:<20}  {}\n", files[i], file_width, subjects[i], subject_width,
               verdicts[i].until ? security::utc_text(*verdicts[i].until) : "",
               verdicts[i].problem.empty() ? "good" : verdicts[i].problem);
}

void print_where_the_ca_is(const fs::path& folder) {
  std::error_code ignored;
  if (fs::exists(security::ca_folder(folder), ignored))
    fmt::print(
        "\n{} holds the private keys of both CAs. Nothing that runs needs them: move the folder off this "
        "machine.\n",
        security::ca_folder(folder).string());
}

}  // namespace

int keys_init(const KeysOptions& options) {
  const fs::path folder = folder_of(options);
  const security::MadeKeys made = security::make_keys(folder, options.days, now(), options.replace);
  fmt::print("made:  {}\nfor:  ", folder.string());
  for (const security::Role role : security::kRoles) fmt::print(" {}", name_of(role));
  fmt::print("\n       and keys that sign the procedure log and the commissioning record\nuntil: {}\n",
             security::utc_text(made.validity.until));
  if (made.old_set) fmt::print("old:   {}\n", made.old_set->string());
  print_where_the_ca_is(folder);
  return 0;
}

int keys_check(const KeysOptions& options) {
  const fs::path folder = folder_of(options);
  std::vector<security::Role> roles = security::roles_present(folder);
  if (roles.empty()) roles.assign(security::kRoles.begin(), security::kRoles.end());  // says what is missing
  const std::vector<security::FileVerdict> verdicts = security::inspect_set(folder, roles, now());
  print_table(verdicts, folder);
  print_where_the_ca_is(folder);
  const auto first = std::find_if(verdicts.begin(), verdicts.end(), [](const security::FileVerdict& verdict) {
    return !verdict.problem.empty();
  });
  if (first == verdicts.end()) return 0;
  fmt::print("\nwhat to do: {}\n", first->remedy);
  return 1;
}

}  // namespace biopsy::robot
