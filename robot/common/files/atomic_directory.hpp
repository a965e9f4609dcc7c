// A folder that appears whole or not at all: it is filled under a temporary name beside its place and
// renamed.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace biopsy {

class AtomicDirectory {
 public:
  // Makes the temporary folder (0700). Throws ConfigError where that cannot be done.
  explicit AtomicDirectory(const std::filesystem::path& destination);
  // What was not settled is removed.
  ~AtomicDirectory();
  AtomicDirectory(const AtomicDirectory&) = delete;
  AtomicDirectory& operator=(const AtomicDirectory&) = delete;

  const std::filesystem::path& path() const { return temporary_; }
  // Mode 0600; the folder around it 0700. Throws ConfigError.
  void write(const std::filesystem::path& file, std::string_view bytes);
  // Puts the folder in its place, when all of it is on the disk. What is there goes to `aside`, if it is
  // given, and otherwise must be nothing or an empty folder. Throws ConfigError with everything as it was.
  void settle(const std::optional<std::filesystem::path>& aside);

 private:
  std::filesystem::path destination_, temporary_;
};

}  // namespace biopsy
