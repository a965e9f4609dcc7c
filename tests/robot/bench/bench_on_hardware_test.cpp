// The experiments of `biopsy characterise` on the laboratory's driver, keys turned by a hand.
#include <gtest/gtest.h>

#include <algorithm>

#include "planner/plan/bench_plan.hpp"
#include "robot/bench/bench_run.hpp"
#include "robot/bench/experiments.hpp"
#include "tests/drivers/nidaqmx/fake_board_config.hpp"

namespace biopsy::robot {
namespace {

constexpr int kHandAfter_ticks = 2'000;

class BenchOnHardware : public testing::Test {
 protected:
  BenchOnHardware() : board_(*fake_reset()), stage_(nidaqmx::laboratory(), fake_now_us) {}

  BenchResult run(int turned_after_ticks) {
    const BenchRun staircase = runs_of({"staircase"}, {.weight = Grams(50.0)}).front();
    const auto plan = planner::plan_bench(bench_request(staircase));
    int ticks = 0;
    const auto keys = [&] {
      if (++ticks == turned_after_ticks) board_.contacts |= 1U;  // the arm key
      const drivers::Panel panel = stage_.panel();
      return BenchKeys{panel.arm, panel.estop_a_closed && panel.estop_b_closed};
    };
    return run_on_bench(staircase, std::get<Plan>(plan), 1, {stage_, [](double) {}, [](double) {}, keys});
  }

  fake::Board& board_;
  nidaqmx::NidaqmxStage stage_;
};

TEST_F(BenchOnHardware, PlaysAStaircaseOnceTheKeyIsTurned) {
  const BenchResult result = run(kHandAfter_ticks);
  EXPECT_EQ(result.stopped_because, "");
  EXPECT_GT(*std::ranges::max_element(result.recorded.displacement), 0.5e-3);
  const auto first_volt =
      std::ranges::find_if(result.recorded.input, [](double volts) { return volts != 0.0; });
  EXPECT_NEAR(static_cast<double>(first_volt - result.recorded.input.begin()), 3'000, 20)
      << "recorded from when the key was turned, hands off";
  EXPECT_EQ(board_.output_V, 0.0);
}

TEST_F(BenchOnHardware, WithoutAHandNothingEverMoves) {
  const BenchResult result = run(0);
  EXPECT_EQ(result.stopped_because, "the arm key was not turned");
  EXPECT_EQ(board_.highest_V, 0.0);
}

// A key that was on before it was requested arms nothing until it is turned off and on.
TEST_F(BenchOnHardware, AKeyThatIsLeftOnIsNoConsent) {
  board_.contacts |= 1U;
  const BenchResult result = run(0);
  EXPECT_EQ(result.stopped_because, "the arm key was not turned");
  EXPECT_TRUE(result.recorded.time.empty());
  EXPECT_EQ(board_.highest_V, 0.0);
}

TEST_F(BenchOnHardware, ThePressedEmergencyStopKeepsItFromStarting) {
  board_.contacts = 0;
  const BenchResult result = run(kHandAfter_ticks);
  EXPECT_NE(result.stopped_because.find("H-25"), std::string::npos) << result.stopped_because;
  EXPECT_EQ(board_.highest_V, 0.0);
}

}  // namespace
}  // namespace biopsy::robot
