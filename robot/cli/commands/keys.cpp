// biopsy keys: makes and looks through the identities and permissions of every process.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <vector>

#include "robot/cli/command.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/security/key_files.hpp"
#include "robot/security/key_set.hpp"
#include "robot/security/make_keys.hpp"

namespace biopsy::robot {
namespace keys_cli {

namespace fs = std::filesystem;

using Json = nlohmann::ordered_json;

struct Options {
  fs::path folder;       // empty: the one `up` uses
  int days = 365;        // of validity
  bool replace = false;  // an existing set is moved aside, not overwritten
};

void add_keys(CLI::App& app, Options& options) {
  add(app, "--keys FOLDER", options.folder, "folder of the set",
      "`$XDG_CONFIG_HOME/biopsy/keys`, or `~/.config/biopsy/keys`");
}

void declare_init(CLI::App& app, Options& options) {
  add_keys(app, options);
  add(app, "--days N", options.days, "validity", "365")
      ->check(in_range(security::kLeastDays, security::kMostDays, "days"));
  app.add_flag("--replace", options.replace,
               "move an existing set aside to `FOLDER.<time>`; without it, an existing set is refused");
}

std::chrono::sys_seconds now() {
  return std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::system_clock::now());
}

fs::path folder_of(const Options& options) {
  return options.folder.empty() ? security::default_folder() : options.folder;
}

std::string table_text(const std::vector<security::FileVerdict>& verdicts, const fs::path& folder) {
  std::size_t file_width = 4, subject_width = 7;
  std::vector<std::string> files, subjects;
  for (const security::FileVerdict& verdict : verdicts) {
    files.push_back(plain(verdict.file.lexically_relative(folder).string()));
    subjects.push_back(plain(verdict.subject));
    file_width = std::max(file_width, files.back().size());
    subject_width = std::max(subject_width, subjects.back().size());
  }
  std::string text = fmt::format("{:<{}}  {:<{}}  {:<20}  verdict\n", "file", file_width, "subject",
                                 subject_width, "valid until");
  for (std::size_t i = 0; i < verdicts.size(); ++i)
    text += fmt::format("{:<{}}  {:<{}}  {:<20}  {}\n", files[i], file_width, subjects[i], subject_width,
                        verdicts[i].until ? security::utc_text(*verdicts[i].until) : "",
                        verdicts[i].problem.empty() ? "good" : verdicts[i].problem);
  return text;
}

std::string ca_notice(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::exists(security::ca_folder(folder), ignored)) return {};
  return fmt::format(
      "\n{} holds the private keys of both CAs. Nothing that runs needs them: move the folder off this "
      "machine.\n",
      security::ca_folder(folder).string());
}

Result init(const Options& options, const Context&) {
  const fs::path folder = folder_of(options);
  const security::MadeKeys made = security::make_keys(folder, options.days, now(), options.replace);
  const std::string until = security::utc_text(made.validity.until);
  std::string roles;
  Json list = Json::array();
  for (const security::Role role : security::kRoles) {
    roles += fmt::format(" {}", name_of(role));
    list.push_back(name_of(role));
  }
  std::string text = fmt::format(
      "made:  {}\nfor:  {}\n       and keys that sign the procedure log and the commissioning record\nuntil: "
      "{}\n",
      folder.string(), roles, until);
  if (made.old_set) text += fmt::format("old:   {}\n", made.old_set->string());
  const Json json = {{"keys", folder.string()},
                     {"roles", list},
                     {"until", until},
                     {"old_set", made.old_set ? Json(made.old_set->string()) : Json(nullptr)}};
  return {.text = text + ca_notice(folder), .json = json.dump(2) + "\n"};
}

Result check(const Options& options, const Context&) {
  const fs::path folder = folder_of(options);
  std::vector<security::Role> roles = security::roles_present(folder);
  if (roles.empty()) roles.assign(security::kRoles.begin(), security::kRoles.end());  // names what is missing
  const std::vector<security::FileVerdict> verdicts = security::inspect_set(folder, roles, now());
  Json files = Json::array();
  for (const security::FileVerdict& verdict : verdicts)
    files.push_back({{"file", verdict.file.lexically_relative(folder).string()},
                     {"subject", verdict.subject},
                     {"until", verdict.until ? Json(security::utc_text(*verdict.until)) : Json(nullptr)},
                     {"problem", verdict.problem.empty() ? Json(nullptr) : Json(verdict.problem)}});
  const auto first = std::find_if(verdicts.begin(), verdicts.end(), [](const security::FileVerdict& verdict) {
    return !verdict.problem.empty();
  });
  const bool good = first == verdicts.end();
  std::string text = table_text(verdicts, folder) + ca_notice(folder);
  if (!good) text += fmt::format("\nwhat to do: {}\n", first->remedy);
  const Json json = {{"keys", folder.string()},
                     {"good", good},
                     {"remedy", good ? Json(nullptr) : Json(first->remedy)},
                     {"files", files}};
  return {.exit_code = good ? 0 : 1,
          .text = text,
          .json = json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"};
}

}  // namespace keys_cli

Command keys_group() {
  using namespace keys_cli;
  return {.name = "keys",
          .summary = "identities and permissions on the robot's bus",
          .description =
              "What they are, who may write what, renewing, revoking: [keys](../how-to/manage-keys.md)."};
}

Command keys_init_command() {
  using namespace keys_cli;
  return {.name = "keys init",
          .summary = "make certificates and permissions for every process",
          .examples = {"biopsy keys init --keys out/keys"},
          .exit_codes = "0, or 2 where nothing was made",
          .json = "`keys`, the folder; `roles`; `until`; `old_set`, where an earlier set is now, or `null`",
          .declare = with_options(declare_init, init)};
}

Command keys_check_command() {
  using namespace keys_cli;
  return {.name = "keys check",
          .summary = "inspect every file: validity, subject, signature",
          .examples = {"biopsy keys check --keys out/keys"},
          .exit_codes = "0 where all are good, 1 where one is not, 2 for no such set",
          .json =
              "`keys`, `good`, `remedy` of the first problem or `null`, and `files`: list of `file`, "
              "`subject`, `until`, `problem`",
          .declare = with_options(add_keys, check)};
}

}  // namespace biopsy::robot
