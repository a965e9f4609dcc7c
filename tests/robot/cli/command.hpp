// Runs the built program as a person would.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "tests/scratch_folder.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::cli_tests {

inline const std::filesystem::path kSource = source_dir();
inline const std::filesystem::path kShared = kSource / "../shared/data";

struct Outcome {
  int code = -1;
  std::string text;  // standard output and error
};

inline Outcome shell(const std::string& line) {
  Outcome outcome;
  FILE* pipe = popen(line.c_str(), "r");
  if (pipe == nullptr) return outcome;
  std::array<char, 4096> buffer{};
  for (std::size_t n = 0; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    outcome.text.append(buffer.data(), n);
  const int status = pclose(pipe);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

inline std::string program() {
  return (binary_dir() / "biopsy").string();
}

// `words`: everything after the program's name, as typed in a shell.
inline Outcome biopsy(const std::string& words) {
  return shell("'" + program() + "' " + words + " 2>&1");
}

// Without what was written to standard error.
inline Outcome standard_output(const std::string& words) {
  return shell("'" + program() + "' " + words + " 2>/dev/null");
}

inline nlohmann::json json_of(const std::filesystem::path& file) {
  return nlohmann::json::parse(file_content(file));
}

}  // namespace biopsy::cli_tests
