#include "robot/common/files/data_folder.hpp"

#include <fmt/format.h>

#include <cstdlib>
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

}  // namespace

fs::path source_folder() {
  return BIOPSY_SOURCE_FOLDER;
}

fs::path data_folder() {
  if (const char* given = std::getenv("BIOPSY_DATA"); given != nullptr && *given != '\0') {
    if (holds_data(given)) return given;
    throw ConfigError("holds no sim/models", fmt::format("BIOPSY_DATA={}", given),
                      "set it to the folder share/biopsy of an installation, or leave it unset");
  }
  const fs::path installed = program_folder().parent_path() / "share/biopsy";
  for (const fs::path& folder : {installed, source_folder()})
    if (holds_data(folder)) return folder;
  throw ConfigError(
      "models and cases are missing", fmt::format("{} and {}", installed.string(), source_folder().string()),
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
