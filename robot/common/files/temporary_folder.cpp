#include "robot/common/files/temporary_folder.hpp"

#include <stdlib.h>

#include "robot/common/config_error.hpp"

namespace biopsy {

namespace fs = std::filesystem;

TemporaryFolder::TemporaryFolder(const std::string& remedy) {
  std::string pattern = (fs::temp_directory_path() / "biopsy-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr)
    throw ConfigError("no temporary folder can be made", fs::temp_directory_path().string(), remedy);
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace biopsy
