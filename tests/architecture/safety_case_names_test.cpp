// The tests that the safety case names exist: a renamed test must not wait for the whole case to be missed.
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>
#include <string>

#include "tests/architecture/lines_of.hpp"
#include "tests/source_dir.hpp"

namespace {

namespace fs = std::filesystem;

// "Suite.Name" of every TEST, TEST_F, TEST_P and TYPED_TEST.
std::set<std::string> declared_tests() {
  const std::regex macro(R"(^(?:TYPED_)?TEST(?:_[FP])?\((\w+), (\w+)\))");
  std::set<std::string> found;
  for (const auto& entry : fs::recursive_directory_iterator(biopsy::source_dir() / "tests"))
    if (entry.path().extension() == ".cpp") {
      const std::vector<std::string> lines = lines_of(entry.path());
      for (std::size_t i = 0; i < lines.size(); ++i) {
        const std::string whole = lines[i] + (i + 1 < lines.size() ? lines[i + 1].substr(0, 120) : "");
        const std::string line = std::regex_replace(whole, std::regex(",\\s+"), ", ");
        std::smatch match;
        if (std::regex_search(line, match, macro)) found.insert(match.str(1) + "." + match.str(2));
      }
    }
  return found;
}

TEST(SafetyCase, NamesTestsThatExist) {
  const std::set<std::string> declared = declared_tests();
  const std::regex named(R"(^  "(?:\w+/)?(\w+\.\w+)(?:/\w+)?",$)");
  std::size_t names = 0;
  for (const std::string& line : lines_of(biopsy::source_dir() / "safety/case/hazards.toml")) {
    std::smatch match;
    if (!std::regex_match(line, match, named)) continue;
    ++names;
    EXPECT_TRUE(declared.contains(match.str(1))) << match.str(1);
  }
  EXPECT_GT(names, 50U) << "the hazards were not read";
}

}  // namespace
