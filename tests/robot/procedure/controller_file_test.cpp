// A file of gains: what was written is read back, and what no loop may run with is refused with its place.
#include "robot/procedure/case/controller_file.hpp"

#include <gtest/gtest.h>

#include "robot/common/config_error.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::robot {
namespace {

TEST(ControllerFile, IsReadBackAsItWasWritten) {
  const ScratchFolder scratch;
  const PiGains gains{.proportional_V_per_mm = 705.9, .integral_V_per_mm_per_tick = 6.612};
  scratch.write("c.toml", controller_toml(gains, "tuned \"here\""));
  const PiGains read = read_controller_file(scratch.path() / "c.toml");
  EXPECT_NEAR(read.proportional_V_per_mm, 705.9, 1e-9);
  EXPECT_NEAR(read.integral_V_per_mm_per_tick, 6.612, 1e-9);
}

// The two units of K_i: 1 kV/(mm s) is a volt per millimetre at each of a second's 1000 ticks.
TEST(ControllerFile, ThePapersGainsAreTheDefaults) {
  const ScratchFolder scratch;
  scratch.write("c.toml", "[controller]\nK_p_kV_per_mm = 0.8\nK_i_kV_per_mm_s = 5\n");
  EXPECT_EQ(read_controller_file(scratch.path() / "c.toml"), PiGains{});
}

TEST(ControllerFile, RefusesWhatNoLoopMayRunWith) {
  const ScratchFolder scratch;
  for (const char* text :
       {"[controller]\nK_p_kV_per_mm = 5\nK_i_kV_per_mm_s = 5\n", "[controller]\nK_p_kV_per_mm = 0.8\n",
        "[controller]\nK_p_kV_per_mm = 0.8\nK_i_kV_per_mm_s = 0\n",
        "[controller]\nK_p_kV_per_mm = nan\nK_i_kV_per_mm_s = 5\n",
        "[controller]\nK_p_kV_per_mm = 0.8\nK_i_kV_per_mm_s = 5\nK_d = 1\n", "K_p_kV_per_mm = 0.8\n", ""}) {
    scratch.write("c.toml", text);
    try {
      read_controller_file(scratch.path() / "c.toml");
      ADD_FAILURE() << "taken: " << text;
    } catch (const ConfigError& e) {
      EXPECT_NE(std::string(e.what()).find("c.toml"), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace biopsy::robot
