#include "robot/common/files/whole_file.hpp"

#include <unistd.h>

#include <fstream>
#include <string>
#include <system_error>

#include "robot/common/config_error.hpp"

namespace biopsy::report {

void atomic_write(const std::filesystem::path& path, std::string_view bytes) {
  std::error_code trouble;
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), trouble);
  // The process number keeps two runs into one folder from writing the same temporary file.
  const std::filesystem::path temporary = path.string() + ".part" + std::to_string(::getpid());
  std::ofstream file(temporary, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (file) std::filesystem::rename(temporary, path, trouble);
  if (!file || trouble) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw ConfigError("cannot write the file", path.string(),
                      "Choose a folder for --out that can be written, on a disk with free space.");
  }
}

}  // namespace biopsy::report
