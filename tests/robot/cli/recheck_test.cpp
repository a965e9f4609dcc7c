// Rehearsals with a new model: margins are those of dry-runs, and a model that the robot cannot work with
// fails.
#include "robot/procedure/recheck.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>

#include "robot/common/config_error.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::cli_tests {
namespace {

const std::filesystem::path kRehearsal = source_dir() / "sim/models/rehearsal.toml";
const std::string kNoisy = "[baseline]\n[effect.sensor_noise]\nstd_mm = 0.010\n";
// An amplifier that gives no more than 1.2 kV lifts nothing to the target.
const std::string kWeak = "[effect.voltage_saturation]\nlevel_kV = 1.2\nknee_kV = 0\n";

robot::Recheck rechecked(const std::filesystem::path& old_model, const std::filesystem::path& new_model) {
  return robot::recheck(old_model, new_model, 0.010, [](double, const std::string&) {});
}

const MarginChange& margin(const robot::Recheck& checked, std::string_view plan, std::string_view quantity) {
  return *std::find_if(checked.margins.begin(), checked.margins.end(),
                       [&](const MarginChange& m) { return m.plan == plan && m.quantity == quantity; });
}

TEST(Recheck, TheSameModelTwiceChangesNoMargin) {
  const robot::Recheck checked = rechecked(kRehearsal, kRehearsal);
  EXPECT_EQ(checked.margins.size(), 20U);
  for (const MarginChange& m : checked.margins) {
    EXPECT_EQ(m.before, m.after) << m.plan << " " << m.quantity;
    EXPECT_TRUE(m.ok) << m.plan << " " << m.quantity;
  }
  EXPECT_TRUE(checked.warnings.empty());
  EXPECT_GT(margin(checked, "liver", "drive voltage").after, 2.0);
  EXPECT_LT(margin(checked, "liver", "drive voltage").after, 4.0);
  EXPECT_EQ(margin(checked, "liver", "drive voltage").limit, 8.0);
}

TEST(Recheck, AModelThatTheRobotCannotWorkWithFailsAndSaysWhy) {
  const ScratchFolder folder;
  folder.write("old.toml", kNoisy);
  folder.write("new.toml", kNoisy + kWeak);
  const robot::Recheck checked = rechecked(folder / "old.toml", folder / "new.toml");
  for (const char* plan : {"gap", "liver"}) {
    const MarginChange& stops = margin(checked, plan, "unplanned stops");
    EXPECT_EQ(stops.before, 0.0);
    EXPECT_GE(stops.after, 1.0);
    EXPECT_FALSE(stops.ok);
    EXPECT_FALSE(margin(checked, plan, "final depth error").ok);
  }
  ASSERT_EQ(checked.warnings.size(), 2U);
  EXPECT_NE(checked.warnings[0].find("plan gap with the new model ended early: "), std::string::npos)
      << checked.warnings[0];
}

TEST(Recheck, LendsASensorsNoiseToAModelThatHasNone) {
  const ScratchFolder folder;
  folder.write("old.toml", kNoisy + kWeak);  // stopped early, so that this takes no time
  folder.write("new.toml", "[baseline]\n" + kWeak);
  const robot::Recheck checked = rechecked(folder / "old.toml", folder / "new.toml");
  for (const MarginChange& m : checked.margins) EXPECT_EQ(m.before, m.after) << m.plan << " " << m.quantity;
  ASSERT_FALSE(checked.warnings.empty());
  EXPECT_NE(checked.warnings.back().find("no [effect.sensor_noise]"), std::string::npos);
  for (const std::string& warning : checked.warnings)
    EXPECT_EQ(warning.find("H-09 d"), std::string::npos) << warning;
  EXPECT_EQ(file_content(folder / "new.toml"), "[baseline]\n" + kWeak) << "the file itself stays";
}

TEST(Recheck, RefusesAFileThatIsNoModel) {
  const ScratchFolder folder;
  folder.write("new.toml", "nonsense");
  EXPECT_THROW(rechecked(kRehearsal, folder / "new.toml"), ConfigError);
  EXPECT_THROW(rechecked(folder / "none.toml", kRehearsal), ConfigError);
}

}  // namespace
}  // namespace biopsy::cli_tests
