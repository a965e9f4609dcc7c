// Keys, contacts and verdicts at the supervisor: what counts as a turn, a press and an image. Levels are made
// by hand, tick by tick, as a person, a welded contact or a process that stands still would make them.
#include "tests/robot/cycle/supervise_bench.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::robot {
namespace {

TEST_F(Supervise, GivesEachPanelLevelToItsOwnInput) {
  verifies("R-03", "R-04");
  bool digital_io::PanelLevels::*const levels[] = {
      &digital_io::PanelLevels::arm_key,        &digital_io::PanelLevels::reset_key,
      &digital_io::PanelLevels::estop_a_closed, &digital_io::PanelLevels::estop_b_closed,
      &digital_io::PanelLevels::bench_key,      &digital_io::PanelLevels::relay_closed};
  bool safety::SupervisorInputs::*const fields[] = {
      &safety::SupervisorInputs::local_arm,       &safety::SupervisorInputs::local_reset,
      &safety::SupervisorInputs::estop_a_closed,  &safety::SupervisorInputs::estop_b_closed,
      &safety::SupervisorInputs::bench_confirmed, &safety::SupervisorInputs::relay_closed};
  for (std::size_t set = 0; set < std::size(levels); ++set) {
    in.panel = {{}, true};
    in.panel.levels.*levels[set] = true;
    memory.panel = {};
    for (int i = 0; i < safety::kContact_ticks; ++i) inputs();
    EXPECT_TRUE(inputs().panel_read) << "whatever its levels";
    for (std::size_t i = 0; i < std::size(fields); ++i)
      EXPECT_EQ(inputs().*fields[i], i == set) << "level " << set << " in input " << i;
  }
}

// Reported: a file edited 20 ms before the arm key was turned was armed, because files are read twice a
// second.
TEST_F(Supervise, TheArmKeyWaitsForFilesThatWereReadAfterItWasTurned) {
  verifies("R-13");
  in.panel = {{.estop_a_closed = true, .estop_b_closed = true}, true};
  const auto ticks = [&](int count) {
    for (int i = 0; i < count; ++i) in.now_us += 1'000, inputs();
    return seen.inputs.local_arm;
  };
  in.files_read_us = in.now_us;
  EXPECT_FALSE(ticks(30));
  in.panel.levels.arm_key = true;
  EXPECT_FALSE(ticks(19)) << "its contact";
  EXPECT_FALSE(ticks(200));
  const std::int64_t turned_us = in.now_us - 199'000;
  in.files_read_us = turned_us - 1;
  EXPECT_FALSE(ticks(1)) << "this reading began a moment before";
  in.files_read_us = turned_us;
  EXPECT_TRUE(ticks(1));
  EXPECT_TRUE(ticks(500)) << "as long as it is turned";
  in.files_read_us = turned_us + 1;
  EXPECT_TRUE(ticks(1));
  in.panel.levels.arm_key = false;
  EXPECT_FALSE(ticks(20));
  in.panel.levels.arm_key = true;
  EXPECT_FALSE(ticks(100)) << "a turn of its own needs a reading of its own";
}

// Reported: a panel that was unread for 30 ms counted as a press of both contacts and as a turn of the keys.
TEST_F(Supervise, APanelThatWasNotReadIsNeitherAPressNorATurn) {
  verifies("R-66");
  const auto stay = [&](int count) {
    for (int i = 0; i < count; ++i) in.now_us += 1'000, in.files_read_us = in.now_us, inputs();
  };
  for (const int unread : {1, 19, 20, 30, 500})
    for (bool digital_io::PanelLevels::*const welded :
         {&digital_io::PanelLevels::reset_key, &digital_io::PanelLevels::arm_key}) {
      memory.panel = {}, memory.evidence.panel = {};
      digital_io::PanelLevels levels{.estop_a_closed = true, .estop_b_closed = true};
      levels.*welded = true;
      in.panel = {levels, true}, stay(100);
      in.panel = {}, stay(unread);
      for (int i = 0; i < 100; ++i) {
        in.panel = {levels, true}, stay(1);
        const bool both_open = !seen.inputs.estop_a_closed && !seen.inputs.estop_b_closed;
        EXPECT_FALSE(seen.inputs.panel_read && both_open) << "a press that nobody made, after " << i;
      }
      in.panel = {{.estop_a_closed = true, .estop_b_closed = true}, true}, stay(40);
      EXPECT_NE(memory.evidence.panel.test, safety::PanelMonitor::Test::Passed);
      EXPECT_NE(memory.evidence.panel.test, safety::PanelMonitor::Test::Pressed);
    }
}

TEST_F(Supervise, AVerdictOnAnImageThatWasNotYetBegunWhenItCameIsNoneLaterEither) {
  verifies("R-67");
  const std::uint64_t tag = planner::plan_tag(plan);
  memory.permit.seq = memory.state.seq = 50;
  in.verdict = {.seq = 1, .plan_tag = tag, .accepted = true, .session = 1, .since_seq = 60};
  for (int i = 0; i < 30; ++i) {
    in.now_us += 1'000;
    EXPECT_FALSE(inputs().depth_accepted) << i;
  }
  in.verdict.since_seq = memory.permit.seq;
  in.now_us += 1'000;
  EXPECT_TRUE(inputs().depth_accepted);
  in.verdict.since_seq = memory.permit.seq + 1;
  EXPECT_FALSE(inputs().depth_accepted);
  in.verdict.since_seq -= 2;
  EXPECT_TRUE(inputs().depth_accepted) << "an earlier one";
  for (const std::uint32_t session : {2U, 1U, 7U, 3U}) {
    in.verdict.session = session, in.verdict.since_seq = memory.permit.seq + 1;
    EXPECT_FALSE(inputs().depth_accepted) << session;
    EXPECT_FALSE(inputs().depth_accepted) << "its permit has come";
    in.verdict.session = session + 100;
    EXPECT_TRUE(inputs().depth_accepted)
        << "another note, which came after it; the session is compared where the hold is";
    in.verdict.since_seq = memory.permit.seq + 1, inputs();
    in.verdict.session = session;
    EXPECT_TRUE(inputs().depth_accepted) << "likewise";
  }
}

}  // namespace
}  // namespace biopsy::robot
