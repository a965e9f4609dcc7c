#include "robot/common/files/output_folder.hpp"

#include <string>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"

namespace biopsy {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMark = ".biopsy-run";

// Names a run writes; whatever else a person has put beside them stays.
bool is_ours(const std::string& name) {
  for (const char* ours :
       {"planning",     "images",           "planning.png",  "report.html",    "report.json",
        "run.csv",      "gap.json",         "model.toml",    "reproduce.json", "calibrated.toml",
        "paper.toml",   "calibration.json", "identify.json", "design.json",    "tune.json",
        "dataset.toml", "safety-case.json", "argument.dot",  "argument.svg",   "evidence",
        "console",      "console.url"})
    if (name == ours) return true;
  return (name.starts_with("stage-") && name.ends_with(".png")) ||
         (name.starts_with("run-") && name.ends_with(".csv"));
}

// The first name on the way from `folder` to `path`; "." for the folder itself, empty where it is elsewhere.
std::string way_into(const fs::path& folder, const fs::path& path) {
  const fs::path way = fs::weakly_canonical(path).lexically_relative(fs::weakly_canonical(folder));
  if (way.empty() || *way.begin() == "..") return {};
  return way.begin()->string();
}

}  // namespace

void keep_apart(const fs::path& folder, const Inputs& inputs) {
  for (const fs::path& input : inputs) {
    if (input.empty()) continue;
    const std::string way = way_into(folder, input);
    if (way == "." || is_ours(way))
      throw ConfigError("lies where the answer shall go, and would be lost", input.string(),
                        "give --out another folder; nothing was touched");
  }
}

void claim_run_folder(const fs::path& folder, const Inputs& inputs) {
  keep_apart(folder, inputs);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder))
    throw ConfigError("is not a folder that can be made" + (error ? ": " + error.message() : std::string()),
                      folder.string(), "give --out a folder that can be written");
  if (!fs::is_empty(folder) && !fs::exists(folder / kMark))
    throw ConfigError("holds files that no run of this program wrote", folder.string(),
                      "give --out an empty or new folder; nothing was touched");
  for (const auto& left : fs::directory_iterator(folder))
    if (is_ours(left.path().filename().string())) fs::remove_all(left.path());
  atomic_write(folder / kMark, "written by biopsy; the next run into this folder clears it\n");
}

}  // namespace biopsy
