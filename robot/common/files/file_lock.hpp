// Holds a log for one recorder: a second one is refused while this lives, also in another process. Ends with
// the process, however that ends.
#pragma once

#include <filesystem>

namespace biopsy::recorder {

class OneWriter {
 public:
  // Throws SetupError where the log is taken or cannot be opened.
  explicit OneWriter(const std::filesystem::path& log);
  ~OneWriter();
  OneWriter(const OneWriter&) = delete;
  OneWriter& operator=(const OneWriter&) = delete;

 private:
  int file_;
};

}  // namespace biopsy::recorder
