#include "robot/common/files/file.hpp"

#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <string>
#include <system_error>

#include "robot/common/config_error.hpp"

namespace biopsy {

namespace fs = std::filesystem;

namespace {

// A device such as /dev/zero never ends; nothing that is read at once is as large.
constexpr std::size_t kFileMax_bytes = std::size_t{1} << 30U, kChunk_bytes = 1U << 20U;

}  // namespace

std::string read_file(const fs::path& file, const std::string& remedy) {
  std::error_code trouble;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) trouble = {errno, std::generic_category()};
  if (fs::is_directory(file)) trouble = std::make_error_code(std::errc::is_a_directory);
  std::string bytes;
  for (std::size_t read = kChunk_bytes; !trouble && read == kChunk_bytes;) {
    if (bytes.size() >= kFileMax_bytes) throw ConfigError("is larger than 1 GB", file.string(), remedy);
    const std::size_t before = bytes.size();
    bytes.resize(before + kChunk_bytes);
    stream.read(bytes.data() + before, kChunk_bytes);
    read = static_cast<std::size_t>(stream.gcount());
    bytes.resize(before + read);
    if (stream.bad()) trouble = std::make_error_code(std::errc::io_error);
  }
  if (trouble) throw ConfigError("cannot be read: " + trouble.message(), file.string(), remedy);
  return bytes;
}

std::string read_file_if_present(const fs::path& file) {
  std::error_code trouble;
  return fs::exists(file, trouble) ? read_file(file) : std::string();
}

void atomic_write(const fs::path& file, std::string_view bytes) {
  std::error_code trouble;
  if (file.has_parent_path()) fs::create_directories(file.parent_path(), trouble);
  // The process number keeps two runs into one folder from writing the same temporary file.
  const fs::path temporary = file.string() + ".part" + std::to_string(::getpid());
  std::ofstream stream(temporary, std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (stream) fs::rename(temporary, file, trouble);
  if (!stream || trouble) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw ConfigError("cannot write the file", file.string(),
                      "Choose a folder for --out that can be written, on a disk with free space.");
  }
}

}  // namespace biopsy
