#include "tests/verification/fault_injection/evidence_file.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace biopsy::proof {

bool write_json(const std::string& file, const nlohmann::json& content) {
  const std::string part = file + ".part";
  std::ofstream stream(part);
  stream << content.dump(2) << '\n';
  stream.close();
  std::error_code error;
  if (stream) std::filesystem::rename(part, file, error);
  if (stream && !error) return true;
  fmt::print(stderr, "{}: cannot be written\n", file);
  return false;
}

}  // namespace biopsy::proof
