#include "tests/source_dir.hpp"

namespace biopsy {

std::filesystem::path source_dir() {
  return BIOPSY_SOURCE_DIR;
}

std::filesystem::path binary_dir() {
  return BIOPSY_BINARY_DIR;
}

}  // namespace biopsy
