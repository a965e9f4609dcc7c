// The house: which room may see which. docs/architecture.md draws it; this holds it.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/safety/verifies.hpp"
#include "tests/source_dir.hpp"

namespace {

namespace fs = std::filesystem;

const fs::path kHouse = biopsy::source_dir();

// Rooms by longest folder, and what each may include besides itself. robot/cli joins all of them.
const std::map<std::string, std::set<std::string>> kMaySee{
    {"robot/msg", {}},
    {"safety", {"robot/msg"}},
    {"robot/control", {"robot/msg"}},
    {"robot/report", {"robot/msg"}},
    {"planner/imaging", {"robot/msg"}},
    {"planner", {"robot/msg"}},
    {"drivers", {"robot/msg", "safety"}},
    {"drivers/digital_io", {"robot/msg", "safety", "drivers"}},
    {"drivers/nidaqmx", {"robot/msg", "safety", "drivers"}},
    {"drivers/commissioning", {"robot/msg", "safety", "drivers"}},
    {"robot/live/realtime", {"robot/msg"}},
    {"robot/transport", {"robot/msg"}},
    {"robot/live",
     {"robot/msg", "safety", "robot/control", "robot/transport", "robot/live/realtime", "drivers/digital_io",
      "drivers", "planner", "robot/security"}},
    {"robot/security", {"robot/msg"}},
    {"robot/recorder", {"robot/msg"}},
    {"robot/console", {"robot/msg"}},
    {"robot/report/safety_case", {"robot/msg", "robot/report"}},
    {"sim", {"robot/msg", "drivers", "safety"}},
    {"sim/gap", {"robot/msg", "sim"}},
    {"sim/paper", {"robot/msg", "robot/control", "sim"}},
    {"sim/paper/calibration", {"robot/msg", "sim", "sim/paper"}},
    {"sim/paper/identification", {"robot/msg", "sim"}},
    {"sim/paper/design", {"robot/msg", "sim"}},
    {"sim/paper/tuning", {"robot/msg", "robot/control", "sim", "sim/paper"}},
    {"robot/cli",
     {"robot/msg",
      "safety",
      "robot/control",
      "robot/report",
      "planner",
      "planner/imaging",
      "drivers",
      "sim",
      "sim/gap",
      "sim/paper",
      "sim/paper/calibration",
      "sim/paper/identification",
      "sim/paper/design",
      "sim/paper/tuning",
      "drivers/digital_io",
      "drivers/nidaqmx",
      "drivers/commissioning",
      "robot/live/realtime",
      "robot/transport",
      "robot/live",
      "robot/security",
      "robot/recorder",
      "robot/report/safety_case",
      "robot/console"}},
};

std::string room_of(const std::string& path) {
  std::string best;
  for (const auto& [room, seen] : kMaySee)
    if (path.starts_with(room + "/") && room.size() > best.size()) best = room;
  return best;
}

std::vector<fs::path> sources() {
  std::vector<fs::path> files;
  for (const char* top : {"robot", "safety", "planner", "drivers", "sim"})
    for (const auto& entry : fs::recursive_directory_iterator(kHouse / top))
      if (entry.path().extension() == ".cpp" || entry.path().extension() == ".hpp")
        files.push_back(entry.path());
  return files;
}

std::vector<std::string> lines_of(const fs::path& file) {
  std::ifstream stream(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(Architecture, EveryRoomIncludesOnlyWhatItMaySee) {
  const std::regex include(R"re(^\s*#include\s+"([^"]+)")re");
  std::size_t seen_includes = 0;
  for (const fs::path& file : sources()) {
    const std::string path = fs::relative(file, kHouse).string();
    const std::string room = room_of(path);
    ASSERT_FALSE(room.empty()) << path << " stands in no room of the house";
    for (const std::string& line : lines_of(file)) {
      std::smatch match;
      if (!std::regex_search(line, match, include)) continue;
      const std::string other = room_of(match[1]);
      EXPECT_TRUE(fs::exists(kHouse / match[1].str()))
          << path << " includes " << match[1] << ", not from the root";
      EXPECT_TRUE(other == room || kMaySee.at(room).contains(other))
          << path << " (" << room << ") includes " << match[1];
      ++seen_includes;
    }
  }
  EXPECT_GT(seen_includes, 200U);
}

// What runs once a millisecond. The bus has locks of its own; these have none, and write to no log.
TEST(Architecture, NothingInTheTickLocksOrWritesALog) {
  const std::regex tick(
      R"(^(safety|robot/control|robot/msg|drivers|drivers/digital_io)/|_loop\.[ch]pp$|)"
      R"(^robot/live/realtime/(tick_clock|latency_histogram)|^drivers/nidaqmx/(nidaqmx_stage|pulse_line))");
  const std::regex banned(
      R"(\b(mutex|lock_guard|scoped_lock|unique_lock|condition_variable|semaphore|latch|spdlog|)"
      R"(printf|fprintf|puts|cout|cerr|clog|syslog|sd_journal\w*)\b|fmt::print)");
  std::size_t judged = 0;
  for (const fs::path& file : sources()) {
    const std::string path = fs::relative(file, kHouse).string();
    if (!std::regex_search(path, tick) || path.starts_with("robot/cli/")) continue;
    ++judged;
    for (std::string line : lines_of(file)) {
      line = line.substr(0, line.find("//"));
      EXPECT_FALSE(std::regex_search(line, banned)) << path << ": " << line;
    }
  }
  EXPECT_GT(judged, 60U);
}

TEST(Architecture, SafetyUsesNoClockHeapInputOutputOrException) {
  const std::set<std::string> allowed{"algorithm",   "array",   "bit",         "concepts", "cstddef",
                                      "cstdint",     "cstdlib", "limits",      "numeric",  "span",
                                      "string_view", "tuple",   "type_traits", "utility"};
  const std::regex standard(R"(^\s*#include\s+<([^>]+)>)");
  const std::regex banned(
      R"(\b(throw|try|catch|new|delete|malloc|double|float|std::string\b|std::vector|static_cast<float>)\b)");
  for (const fs::path& file : sources()) {
    if (room_of(fs::relative(file, kHouse).string()) != "safety") continue;
    for (std::string line : lines_of(file)) {
      line = line.substr(0, line.find("//"));
      std::smatch match;
      if (std::regex_search(line, match, standard)) {
        EXPECT_TRUE(allowed.contains(match[1])) << file << ": " << line;
      }
      line = std::regex_replace(line, std::regex("\"[^\"]*\""), "\"\"");
      EXPECT_FALSE(std::regex_search(line, banned)) << file << ": " << line;
    }
  }
}

TEST(Architecture, OnlyTheGateMakesAVoltage) {
  biopsy::verifies("R-35");
  const std::regex made(R"(GatedVoltage\s*[({]\s*[^)}\s])");
  for (const fs::path& file : sources()) {
    const std::string path = fs::relative(file, kHouse).string();
    if (path == "safety/gate.cpp" || path == "safety/gate.hpp") continue;
    for (const std::string& line : lines_of(file))
      EXPECT_FALSE(std::regex_search(line, made)) << path << ": " << line;
  }
}

TEST(Architecture, FilesAreOneIdeaLongAndNamedForIt) {
  for (const fs::path& file : sources()) {
    EXPECT_LE(lines_of(file).size(), 400U) << file;
    for (const char* nothing : {"util", "helper", "common", "misc", "manager"})
      EXPECT_EQ(file.filename().string().find(nothing), std::string::npos) << file << " says nothing";
  }
}

}  // namespace
