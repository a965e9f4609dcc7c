// Runs the built program as a person would, and keeps what it said.
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

namespace biopsy::stories {

inline const std::filesystem::path kHouse = source_dir();
inline const std::filesystem::path kShared = kHouse / "../shared/data";

struct Answer {
  int code = -1;
  std::string text;  // standard output and error
};

// `words`: everything after the program's name, as typed in a shell.
inline Answer biopsy(const std::string& words) {
  const std::string line = "'" + (binary_dir() / "biopsy").string() + "' " + words + " 2>&1";
  Answer answer;
  FILE* pipe = popen(line.c_str(), "r");
  if (pipe == nullptr) return answer;
  std::array<char, 4096> buffer{};
  for (std::size_t n = 0; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    answer.text.append(buffer.data(), n);
  const int status = pclose(pipe);
  answer.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return answer;
}

inline nlohmann::json json_of(const std::filesystem::path& file) {
  return nlohmann::json::parse(file_content(file));
}

}  // namespace biopsy::stories
