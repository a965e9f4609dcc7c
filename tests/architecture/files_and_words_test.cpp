// Architecture tests: size of files and folders, and the names that the code uses. The words come from the
// table "Words" of the plan of the code: names that were replaced by the field's own terms.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/architecture/lines_of.hpp"
#include "tests/source_dir.hpp"

namespace {

namespace fs = std::filesystem;

const std::set<std::string> kCode{".cpp", ".hpp", ".idl", ".ts", ".tsx", ".cmake", ".txt"};

// Every file below the source folders, data for tests left out.
std::vector<fs::path> files(bool with_tests) {
  std::vector<std::string> tops{"robot", "safety", "planner", "drivers", "sim", "cmake", "docs"};
  if (with_tests) tops.emplace_back("tests");
  std::vector<fs::path> found;
  for (const std::string& top : tops)
    for (const auto& entry : fs::recursive_directory_iterator(biopsy::source_dir() / top)) {
      const std::string path = entry.path().string();
      const bool is_data = path.find("/corpus/") != std::string::npos ||
                           path.find("/docs/examples/") != std::string::npos ||
                           path.find("/baselines/") != std::string::npos;
      if (entry.is_regular_file() && !is_data) found.push_back(entry.path());
    }
  return found;
}

TEST(Files, HaveAtMost400LinesAndAMedianOf150) {
  std::vector<std::size_t> lengths;
  for (const fs::path& file : files(true)) {
    if (!kCode.contains(file.extension())) continue;
    lengths.push_back(lines_of(file).size());
    EXPECT_LE(lengths.back(), 400U) << file;
  }
  ASSERT_GT(lengths.size(), 500U) << "the source folders were not read";
  std::ranges::nth_element(lengths, lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2));
  EXPECT_LE(lengths[lengths.size() / 2], 150U);
}

TEST(Files, AreNamedForTheirContent) {
  for (const fs::path& file : files(false))
    for (const char* nothing : {"util", "helper", "misc", "manager"})
      EXPECT_EQ(file.filename().string().find(nothing), std::string::npos) << file;
}

TEST(Folders, HoldAtMost25Files) {
  std::map<fs::path, int> count;
  for (const fs::path& file : files(true)) ++count[file.parent_path()];
  for (const auto& [folder, n] : count) EXPECT_LE(n, 25) << folder;
}

TEST(Names, AreTheTermsOfTheField) {
  const std::regex replaced(
      R"(\b(side_letters|spoken_program|run_and_listen|Spoken|\w+_words|console_tells|clinician_asks|Wires|World)"
      R"(|SupervisedStage|copper_|Doorkeeper|rising_number|WebHouse|Guest|GuestRules|OneWriter|NewFolder)"
      R"(|whole_file|confess_losses|LogScribe|outside_text|DepthWatch|obey|take_permit|is_hot|WiredRealStage)"
      R"(|PacedStage|contest|hold_round|conclude|Judged|Entrant|stood_alone|Knob|tamed|Surroundings|Passage)"
      R"(|let_back|workshop|way_home|kHouse|read_once|TOGETHER|APART|StageReached|StageDepth|StageRunner)"
      R"(|accepted_stage|stage_limits|stage_reached)\b)");
  for (const fs::path& file : files(true)) {
    if (!kCode.contains(file.extension()) || file.filename() == "files_and_words_test.cpp") continue;
    int number = 0;
    for (const std::string& line : lines_of(file)) {
      ++number;
      EXPECT_FALSE(std::regex_search(line, replaced)) << file.string() << ":" << number << ": " << line;
    }
  }
}

}  // namespace
