// The cases of the procedure matrix: every built-in one and a patient's, with the number of images in their
// plans.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>

#include "tests/robot/cli/command.hpp"

namespace biopsy::robot {

namespace fs = std::filesystem;

constexpr const char* kPatientsCase = "docs/examples/case.toml";
inline const std::map<std::string, int> kImages{{"gap", 1}, {"liver", 2}, {kPatientsCase, 3}};

// A folder with the patient's case and the image that it names.
inline const fs::path& patient_folder() {
  static const ScratchFolder folder;
  static const bool made = [] {
    fs::create_directories(folder / "docs");
    fs::copy(source_dir() / "docs/examples", folder / "docs/examples", fs::copy_options::recursive);
    fs::copy(source_dir() / "sim", folder / "sim", fs::copy_options::recursive);
    return cli_tests::biopsy("dry-run liver --out " + (folder / "out/liver").string()).code == 0;
  }();
  EXPECT_TRUE(made);
  return folder.path();
}

inline std::string case_file(const std::string& name) {
  return name == kPatientsCase ? (patient_folder() / name).string() : name;
}

inline std::size_t folders_in(const fs::path& folder) {
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(folder)) count += entry.is_directory();
  return count;
}

}  // namespace biopsy::robot
