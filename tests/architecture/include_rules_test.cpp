// Architecture tests: which folder may include which. docs/explanation/architecture.md draws it.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/architecture/lines_of.hpp"
#include "tests/safety/verifies.hpp"
#include "tests/source_dir.hpp"

namespace {

namespace fs = std::filesystem;

const fs::path kSource = biopsy::source_dir();

// Layers from the ground up. A folder includes itself, any lower layer, and what is named beside it in its
// own.
struct Folder {
  std::string folder;
  int layer;
  std::set<std::string> beside;
};
const std::vector<Folder> kFolders{
    {"robot/common", 0, {}},
    {"robot/msg", 1, {}},
    {"safety", 2, {}},
    {"robot/control", 2, {}},
    {"planner/plan", 3, {}},
    {"planner/imaging", 3, {}},
    {"drivers", 3, {"drivers/nidaqmx"}},  // the factory
    {"drivers/digital_io", 3, {"drivers"}},
    {"drivers/nidaqmx", 3, {"drivers"}},
    {"drivers/commissioning", 3, {"drivers"}},
    {"sim", 3, {"drivers"}},  // the simulated stage implements the drivers' interface
    {"sim/gap", 3, {"sim"}},
    {"sim/paper", 3, {"sim"}},
    {"sim/paper/calibration", 3, {"sim", "sim/paper"}},
    {"sim/paper/missing", 3, {"sim", "sim/paper", "sim/paper/calibration"}},
    {"sim/paper/identification", 3, {"sim", "sim/paper"}},
    {"sim/paper/design", 3, {"sim", "sim/paper"}},
    {"sim/paper/tuning", 3, {"sim", "sim/paper"}},
    {"robot/transport", 4, {}},
    {"robot/security", 4, {}},
    {"robot/recorder", 4, {}},
    {"robot/report", 4, {}},
    {"robot/live/realtime", 4, {}},
    {"robot/cycle", 5, {}},
    {"robot/procedure", 6, {}},
    {"robot/live", 6, {}},
    {"robot/igtl", 7, {}},
    {"robot/live/session", 7, {}},
    {"robot/live/processes", 7, {}},
    {"robot/bench", 8, {}},
    {"robot/console", 8, {}},
    {"robot/cli", 9, {}},
    {"robot/python", 9, {}},
};

const Folder& folder_named(const std::string& folder) {
  return *std::find_if(kFolders.begin(), kFolders.end(),
                       [&](const Folder& one) { return one.folder == folder; });
}

bool may_include(const std::string& from, const std::string& to) {
  const Folder &upper = folder_named(from), &lower = folder_named(to);
  return from == to || lower.layer < upper.layer || upper.beside.contains(to);
}

std::string folder_of(const std::string& path) {
  std::string best;
  for (const Folder& one : kFolders)
    if (path.starts_with(one.folder + "/") && one.folder.size() > best.size()) best = one.folder;
  return best;
}

std::vector<fs::path> sources() {
  std::vector<fs::path> files;
  for (const char* top : {"robot", "safety", "planner", "drivers", "sim"})
    for (const auto& entry : fs::recursive_directory_iterator(kSource / top))
      if (entry.path().extension() == ".cpp" || entry.path().extension() == ".hpp")
        files.push_back(entry.path());
  return files;
}

TEST(Architecture, EveryFolderIncludesOnlyLowerLayers) {
  const std::regex include(R"re(^\s*#include\s+"([^"]+)")re");
  std::size_t seen_includes = 0;
  for (const fs::path& file : sources()) {
    const std::string path = fs::relative(file, kSource).string();
    const std::string folder = folder_of(path);
    ASSERT_FALSE(folder.empty()) << path << " is in no folder with a layer";
    for (const std::string& line : lines_of(file)) {
      std::smatch match;
      if (!std::regex_search(line, match, include)) continue;
      const std::string other = folder_of(match[1]);
      EXPECT_TRUE(fs::exists(kSource / match[1].str()) ||
                  fs::exists(biopsy::binary_dir() / "generated" / match[1].str()))
          << path << " includes " << match[1] << ", not from the root";
      ASSERT_FALSE(other.empty()) << path << " includes " << match[1];
      EXPECT_TRUE(may_include(folder, other)) << path << " (" << folder << ") includes " << match[1];
      ++seen_includes;
    }
  }
  EXPECT_GT(seen_includes, 200U);
}

// What runs once a millisecond. The bus has locks of its own; these have none, and write to no log.
TEST(Architecture, NothingInTheTickLocksOrWritesALog) {
  const std::regex tick(
      R"(^(safety|robot/control|robot/msg|robot/cycle|drivers/digital_io)/|^drivers/[a-z_]+\.[ch]pp$|_loop\.[ch]pp$|)"
      R"(^robot/live/realtime/(tick_clock|latency_histogram)|^drivers/nidaqmx/(nidaqmx_stage|pulse_line))");
  const std::regex banned(
      R"(\b(mutex|lock_guard|scoped_lock|unique_lock|condition_variable|semaphore|latch|spdlog|)"
      R"(printf|fprintf|puts|cout|cerr|clog|syslog|sd_journal\w*)\b|fmt::print|logging::(Logger|write)|logging/logger\.hpp)");
  std::size_t judged = 0;
  for (const fs::path& file : sources()) {
    const std::string path = fs::relative(file, kSource).string();
    if (!std::regex_search(path, tick) || path.starts_with("robot/console/")) continue;
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
    if (folder_of(fs::relative(file, kSource).string()) != "safety") continue;
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
    const std::string path = fs::relative(file, kSource).string();
    if (path == "safety/gate.cpp" || path == "safety/gate.hpp") continue;
    for (const std::string& line : lines_of(file))
      EXPECT_FALSE(std::regex_search(line, made)) << path << ": " << line;
  }
}

}  // namespace
