#include "robot/common/files/output_folder.hpp"

#include <unistd.h>

#include <algorithm>
#include <string_view>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"

namespace biopsy {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMark = ".biopsy-run";

bool matches(std::string_view name, std::string_view pattern) {
  const std::size_t star = pattern.find('*');
  if (star == std::string_view::npos) return name == pattern;
  return name.size() + 1 >= pattern.size() && name.starts_with(pattern.substr(0, star)) &&
         name.ends_with(pattern.substr(star + 1));
}

bool is_one_of(const FileNames& names, const std::string& name) {
  return std::any_of(names.begin(), names.end(), [&](const std::string& one) { return matches(name, one); });
}

// The mark of a run, or one that a killed run did not finish.
bool is_mark(const fs::directory_entry& entry) {
  return entry.path().filename().string().starts_with(kMark);
}

// The first name on the way from `folder` to `path`; "." for the folder itself, empty where it is elsewhere.
std::string way_into(const fs::path& folder, const fs::path& path) {
  const fs::path way = fs::weakly_canonical(path).lexically_relative(fs::weakly_canonical(folder));
  if (way.empty() || *way.begin() == "..") return {};
  return way.begin()->string();
}

}  // namespace

void keep_apart(const fs::path& folder, const Inputs& inputs, const FileNames& names) {
  for (const fs::path& input : inputs) {
    if (input.empty()) continue;
    const std::string way = way_into(folder, input);
    if (way == "." || is_one_of(names, way))
      throw ConfigError("lies where the result is written, and would be lost", input.string(),
                        "give --out another folder; nothing was touched");
  }
}

void make_output_folder(const fs::path& folder, const Inputs& inputs, const FileNames& names) {
  keep_apart(folder, inputs, names);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder) || ::access(folder.c_str(), W_OK | X_OK) != 0)
    throw ConfigError(
        "is not a folder that can be written" + (error ? ": " + error.message() : std::string()),
        folder.string(), "give --out a folder that can be written");
}

void claim_run_folder(const fs::path& folder, const Inputs& inputs, const FileNames& names) {
  make_output_folder(folder, inputs, names);
  if (!fs::exists(folder / kMark) &&
      !std::all_of(fs::directory_iterator(folder), fs::directory_iterator(), is_mark))
    throw ConfigError("holds files that no run of this program wrote", folder.string(),
                      "give --out an empty or new folder; nothing was touched");
  atomic_write(folder / kMark, "written by biopsy; the next run into this folder clears it\n");
  for (const auto& left : fs::directory_iterator(folder)) {
    const std::string name = left.path().filename().string();
    if (is_one_of(names, name) || (is_mark(left) && name != kMark)) fs::remove_all(left.path());
  }
}

}  // namespace biopsy
