// The number of a start: larger than any before it, and about the time of day.
#include "robot/live/monotonic_session_id.hpp"

#include <gtest/gtest.h>

#include <ctime>
#include <string>

#include "robot/common/config_error.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::live {
namespace {

struct MonotonicSessionId : testing::Test {
  std::uint32_t after(const std::string& last) const {
    folder.write("session", last);
    return monotonic_session_id(file);
  }
  // "where: what; remedy" of a refusal.
  static std::string refusal(const std::filesystem::path& of) {
    try {
      return "given " + std::to_string(monotonic_session_id(of));
    } catch (const ConfigError& error) {
      return error.where + ": " + error.what_is_wrong + "; " + error.remedy;
    }
  }

  const ScratchFolder folder;
  const std::filesystem::path file = folder / "session";
};

TEST_F(MonotonicSessionId, RisesFromStartToStartWhateverTheWallClockSays) {
  const std::uint32_t first = monotonic_session_id(file);
  EXPECT_NEAR(first, static_cast<double>(std::time(nullptr)), 60.0) << "seconds since 1970";
  EXPECT_EQ(file_content(file), std::to_string(first) + "\n");
  EXPECT_EQ(after(std::to_string(first + 100)), first + 101) << "many starts within a second";
  EXPECT_EQ(monotonic_session_id(file), first + 102);
  EXPECT_EQ(after("4000000000\n"), 4'000'000'001U) << "a clock that was set back since";
  EXPECT_EQ(monotonic_session_id(file), 4'000'000'002U);
  EXPECT_EQ(after("4294967294"), 4'294'967'295U) << "the last number that there is";
  EXPECT_NEAR(after("0"), first, 60.0);
  EXPECT_NEAR(after("1000000000"), first, 60.0);
}

TEST_F(MonotonicSessionId, IsRefusedWhereTheLastOneIsNotKnown) {
  for (const char* text : {"", "soon", "-1", "4294967295", "4294967296", "99999999999999999999"}) {
    folder.write("session", text);
    EXPECT_EQ(refusal(file), file.string() +
                                 ": holds no number of the last start; "
                                 "remove it once no process of this robot runs any more")
        << text;
    EXPECT_EQ(file_content(file), text);
  }
  EXPECT_EQ(refusal(folder / "nowhere" / "session"), (folder / "nowhere").string() +
                                                         ": the folder of the last start is not there; "
                                                         "create the run folder first: biopsy up");
  EXPECT_FALSE(std::filesystem::exists(folder / "nowhere")) << "a new folder would hide the last number";
}

}  // namespace
}  // namespace biopsy::live
