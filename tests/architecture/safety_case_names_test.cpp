// The tests that the safety case names exist: a renamed test must not wait for the whole case to be missed.
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/architecture/lines_of.hpp"
#include "tests/source_dir.hpp"

namespace {

namespace fs = std::filesystem;

// "Suite.Name" of every TEST, TEST_F, TEST_P and TYPED_TEST, and of every script that is a test.
std::set<std::string> declared_tests() {
  const std::regex macro(R"(^(?:TYPED_)?TEST(?:_[FP])?\((\w+), (\w+)\))");
  const std::regex script(R"(add_test\(NAME (\w+\.\w+))");
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
    } else if (entry.path().filename() == "CMakeLists.txt") {
      std::smatch match;
      for (const std::string& line : lines_of(entry.path()))
        if (std::regex_search(line, match, script)) found.insert(match[1]);
    }
  return found;
}

// What stands between `tests = [` and `]`, as written.
std::vector<std::string> named_tests(const char* file) {
  std::vector<std::string> names;
  bool inside = false;
  const std::regex quoted(R"rx("([^"]+)")rx");
  for (const std::string& line : lines_of(biopsy::source_dir() / "safety/case" / file)) {
    inside = inside || line.starts_with("tests = [");
    if (inside)
      for (std::sregex_iterator name(line.begin(), line.end(), quoted), end; name != end; ++name)
        names.push_back((*name)[1]);
    if (line.ends_with("]")) inside = false;
  }
  return names;
}

// "FILE.spec.ts: TITLE", a test of the console's page.
bool is_browser_test(const std::string& name) {
  const std::size_t colon = name.find(": ");
  const fs::path file = biopsy::source_dir() / "tests/robot/console" / name.substr(0, colon);
  if (!fs::exists(file)) return false;
  for (const std::string& line : lines_of(file))
    if (line.find("test('" + name.substr(colon + 2) + "'") != std::string::npos) return true;
  return false;
}

TEST(SafetyCase, NamesTestsThatExist) {
  const std::set<std::string> declared = declared_tests();
  const std::regex named(R"((?:\w+/)?(\w+\.\w+)(?:/\w+)?)");
  for (const auto& [file, fewest] :
       {std::pair{"hazards.toml", 70U}, std::pair{"threats.toml", 30U}, std::pair{"scenarios.toml", 25U}}) {
    const std::vector<std::string> names = named_tests(file);
    EXPECT_GT(names.size(), fewest) << file << " was not read";
    for (const std::string& name : names) {
      std::smatch match;
      if (name.find(".spec.ts: ") != std::string::npos)
        EXPECT_TRUE(is_browser_test(name)) << file << ": " << name;
      else
        EXPECT_TRUE(std::regex_match(name, match, named) && declared.contains(match.str(1)))
            << file << ": " << name;
    }
  }
}

}  // namespace
