// Holds a log for one recorder: a second one is refused while this lives, also in another process. Ends with
// the process, however that ends.
#pragma once

#include <filesystem>

namespace biopsy {

class FileLock {
 public:
  // Throws ConfigError where the log is taken or cannot be opened.
  explicit FileLock(const std::filesystem::path& log);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int file_;
};

}  // namespace biopsy
