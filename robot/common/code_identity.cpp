#include "robot/common/code_identity.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <vector>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/sha256.hpp"
#include "robot/common/subprocess.hpp"
#include "robot/common/text/encoding.hpp"

namespace biopsy {
namespace {

namespace fs = std::filesystem;

// What running the tests leaves in the tree.
bool is_cache(const fs::path& folder) {
  return folder.filename() == "__pycache__" || folder.filename() == "node_modules";
}

std::vector<fs::path> code_files(const fs::path& tree) {
  std::vector<fs::path> files{tree / "CMakeLists.txt", tree / "CMakePresets.json"};
  for (const char* folder : {"cmake", "robot", "safety", "planner", "drivers", "sim", "tests"})
    for (auto entry = fs::recursive_directory_iterator(tree / folder); entry != fs::end(entry); ++entry) {
      if (entry->is_directory() && is_cache(entry->path())) entry.disable_recursion_pending();
      if (entry->is_regular_file()) files.push_back(entry->path());
    }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

std::string code_fingerprint(const fs::path& tree) {
  if (!fs::exists(tree / "safety"))
    throw ConfigError("the source tree is not there", tree.string(),
                      "run ./dev safety-case in a source tree");
  std::string all;
  for (const fs::path& file : code_files(tree)) {
    const std::string bytes = read_file(file);
    all += fmt::format("{}\n{}\n", fs::relative(file, tree).generic_string(), bytes.size()) + bytes;
  }
  return hex(sha256(all));
}

std::string commit_of(const fs::path& tree) {
  const ProcessResult head = run_subprocess({"git", "-C", tree.string(), "rev-parse", "HEAD"});
  if (head.exit_code != 0 || head.text.size() < 40) return "unknown";
  const ProcessResult changed =
      run_subprocess({"git", "-C", tree.string(), "status", "--porcelain", "--untracked-files=no"});
  return head.text.substr(0, 40) + (changed.exit_code == 0 && changed.text.empty() ? "" : "+");
}

std::string utc_now() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

}  // namespace biopsy
