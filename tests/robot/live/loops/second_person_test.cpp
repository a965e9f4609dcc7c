// The supervisor's loop and the second person, who confirms a plan apart from the console.
#include "tests/robot/live/loops/supervisor_loop_bench.hpp"

namespace biopsy::loops_tests {
namespace {

TEST_F(SupervisorLoopBench, TakesEachConfirmationOfASecondPersonOnce) {
  turn(1'000);
  EXPECT_TRUE(calls.confirmed.empty());
  std::int64_t us = 1'000;
  fields::for_each_field(PlanConfirmation{1, {2}, "a"}, [&](auto, const PlanConfirmation& given) {
    fake_bus::put(given);
    turn(us += 1'000);
    EXPECT_EQ(calls.confirmed.back(), (std::pair{given, kStart_us + us})) << "and when it came";
  });
  const std::size_t taken = calls.confirmed.size();
  turn(us + 1'000);
  EXPECT_EQ(calls.confirmed.size(), taken) << "once";
}

TEST_F(SupervisorLoopBench, NeedsASecondPersonWhereItsStageDoes) {
  turn(1'000);
  EXPECT_FALSE(calls.needs_second_person);
  live::SupervisorLoop of_real_stage(bus, pulse, panel, files, kConfig, kSession, safety::SelfTest::Passed,
                                     true);
  fake_bus::put(Measurement{});
  of_real_stage.turn();
  EXPECT_TRUE(calls.needs_second_person);
}

}  // namespace
}  // namespace biopsy::loops_tests
