// A folder for files that nobody keeps.
#pragma once

#include <filesystem>
#include <string>

namespace biopsy {

// Below $TMPDIR or /tmp; removed with its content at the end, also after an exception.
class TemporaryFolder {
 public:
  // Throws ConfigError, with `remedy` as what to do, where it cannot be made.
  explicit TemporaryFolder(
      const std::string& remedy = "free some space there, or set TMPDIR to another folder");
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace biopsy
