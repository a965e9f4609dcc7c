#include "robot/cli/accepted_model.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <system_error>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "sim/plant/model_file.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, const std::string& reason) {
  throw ConfigError(fmt::format("the model cannot be replaced: {}", reason), file.string(),
                    "give --model a file in a folder that can be written, on a disk with free space");
}

fs::path replaceable(const fs::path& model_file) {
  std::error_code trouble;
  fs::path file = fs::canonical(model_file, trouble);
  if (trouble) refuse(model_file, trouble.message());
  if (!fs::is_regular_file(file)) refuse(model_file, "it is not a file");
  // access() alone is not enough: root may write a file that is marked read-only.
  const fs::perms anyone = fs::perms::owner_write | fs::perms::group_write | fs::perms::others_write;
  if ((fs::status(file).permissions() & anyone) == fs::perms::none || ::access(file.c_str(), W_OK) != 0)
    refuse(model_file, "it is read-only");
  return file;
}

// A copy under the first free number. The copy refuses to overwrite, so two programs never share a number.
fs::path keep_old(const fs::path& file) {
  for (int number = 1;; ++number) {
    fs::path old = fmt::format("{}.{}", file.string(), number);
    std::error_code trouble;
    if (fs::exists(fs::symlink_status(old, trouble))) continue;
    if (fs::copy_file(file, old, fs::copy_options::none, trouble)) return old;
    if (trouble == std::errc::file_exists) continue;
    std::error_code ignored;
    fs::remove(old, ignored);
    refuse(file, fmt::format("{}: {}", old.string(), trouble.message()));
  }
}

}  // namespace

std::filesystem::path accept_model(const std::filesystem::path& model_file, const std::string& new_text) {
  const fs::path file = replaceable(model_file);
  sim::parse_model(new_text, "the new text of " + model_file.string());
  const fs::perms mode = fs::status(file).permissions();
  fs::path old = keep_old(file);
  std::error_code trouble;
  try {
    atomic_write(file, new_text);
  } catch (const ConfigError& error) {
    fs::remove(old, trouble);
    refuse(model_file, error.what_is_wrong);
  }
  fs::permissions(file, mode, trouble);
  return old;
}

void refuse_unless_replaceable(const fs::path& model_file) {
  replaceable(model_file);
}

}  // namespace biopsy::robot
