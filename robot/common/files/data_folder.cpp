#include "robot/common/files/data_folder.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <string>
#include <system_error>

#include "robot/common/config_error.hpp"

namespace biopsy {
namespace {

namespace fs = std::filesystem;

bool holds_data(const fs::path& folder) {
  return fs::exists(folder / "sim/models");
}

fs::path program_folder() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error).parent_path();
}

// As the build tree says it; empty for an installed program, which knows nothing of where it was built.
fs::path source_of_the_build() {
  for (fs::path folder = program_folder(); folder.has_relative_path(); folder = folder.parent_path())
    if (std::ifstream told{folder / "source_folder.txt"}; told) {
      std::string source;
      std::getline(told, source);
      return source;
    }
  return {};
}

}  // namespace

fs::path source_folder() {
  if (const fs::path source = source_of_the_build(); !source.empty()) return source;
  throw ConfigError("the source tree is not there", program_folder().string(),
                    "run the program of a build tree: ./dev build");
}

fs::path data_folder() {
  if (const char* given = std::getenv("BIOPSY_DATA"); given != nullptr && *given != '\0') {
    if (holds_data(given)) return given;
    throw ConfigError("holds no sim/models", fmt::format("BIOPSY_DATA={}", given),
                      "set it to the folder share/biopsy of an installation, or leave it unset");
  }
  const fs::path installed = program_folder().parent_path() / "share/biopsy", source = source_of_the_build();
  for (const fs::path& folder : {installed, source})
    if (!folder.empty() && holds_data(folder)) return folder;
  throw ConfigError(
      "models and cases are missing",
      source.empty() ? installed.string() : fmt::format("{} and {}", installed.string(), source.string()),
      "install the program whole (cmake --install), or set BIOPSY_DATA to its folder share/biopsy");
}

fs::path page_folder() {
  const fs::path installed = data_folder() / "console/page", built = program_folder() / "console/page/dist";
  for (const fs::path& folder : {installed, built})
    if (fs::exists(folder / "index.html")) return folder;
  throw ConfigError("the console's page is missing",
                    fmt::format("{} and {}", installed.string(), built.string()),
                    "install biopsy-console, or build the page: ./dev build");
}

}  // namespace biopsy
