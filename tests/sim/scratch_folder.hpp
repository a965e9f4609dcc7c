// A folder for the files of one test, gone when the test ends; and what a reader says when it refuses.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "robot/messages/setup_error.hpp"

namespace biopsy::sim {

class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "biopsy_sim_XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  void write(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
  }

 private:
  std::filesystem::path path_;
};

// Where, what and what to do, as one text; "accepted" where nothing was refused.
template <class Read>
std::string refusal(Read&& read) {
  try {
    read();
  } catch (const SetupError& error) {
    return error.where + ": " + error.what_is_wrong + " [" + error.remedy + "]";
  }
  return "accepted";
}

inline void expect_says(const std::string& said, const std::string& place, const std::string& reason) {
  EXPECT_EQ(said.rfind(place, 0), 0U) << said << "\n  should begin with " << place;
  EXPECT_NE(said.find(reason), std::string::npos) << said << "\n  should say " << reason;
  EXPECT_EQ(said.find("[]"), std::string::npos) << said << "\n  should say what to do";
}

}  // namespace biopsy::sim
