#include "robot/common/code_identity.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <iterator>
#include <memory>
#include <vector>

#include "robot/common/config_error.hpp"
#include "robot/common/subprocess.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;

bool is_code(const fs::path& file) {
  for (const char* extension : {".cpp", ".hpp", ".toml", ".idl", ".txt", ".json", ".py", ".pml"})
    if (file.extension() == extension) return true;
  return false;
}

std::vector<fs::path> code_files(const fs::path& tree) {
  std::vector<fs::path> files;
  for (const char* room : {"robot", "safety", "planner", "drivers", "sim", "tests"})
    for (const auto& entry : fs::recursive_directory_iterator(tree / room))
      if (entry.is_regular_file() && is_code(entry.path())) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) throw ConfigError("cannot be read", file.string(), "check the source tree");
  return bytes;
}

}  // namespace

std::string code_fingerprint(const fs::path& tree) {
  if (!fs::exists(tree / "safety"))
    throw ConfigError("the source tree is not there", tree.string(),
                      "run ./dev safety-case in a source tree");
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> hash(EVP_MD_CTX_new(), EVP_MD_CTX_free);
  EVP_DigestInit_ex(hash.get(), EVP_sha256(), nullptr);
  for (const fs::path& file : code_files(tree)) {
    const std::string bytes = bytes_of(file);
    const std::string title =
        fmt::format("{}\n{}\n", fs::relative(file, tree).generic_string(), bytes.size());
    EVP_DigestUpdate(hash.get(), title.data(), title.size());
    EVP_DigestUpdate(hash.get(), bytes.data(), bytes.size());
  }
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned size = 0;
  EVP_DigestFinal_ex(hash.get(), digest, &size);
  return fmt::format("{:02x}", fmt::join(digest, digest + size, ""));
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

}  // namespace biopsy::robot
