// What the controller's loop gathers for a tick and what it sends.
#include "robot/live/controller_loop.hpp"

#include "drivers/digital_io/shared_io.hpp"
#include "tests/robot/live/loops/bench.hpp"

namespace biopsy::loops_tests {
namespace {

struct ControllerLoopBench : LoopBench {
  void turn(const Measurement& measured = next()) {
    fake_bus::put(measured);
    loop.turn(std::chrono::milliseconds(5));
  }
  static Measurement next() {
    static std::uint32_t seq = 0;
    Measurement measured;
    measured.seq = ++seq;
    return measured;
  }
  const robot::ControllerInputs& last() const { return calls.controlled.back(); }

  live::ControllerLoop loop{bus, kConfig};
};

// A new member of the inputs makes this fail to compile, until a test claims where it comes from.
void expect_same(const robot::ControllerInputs& a, const robot::ControllerInputs& b) {
  const auto& [measurement, permit, step, finish, hold_still, overruns] = a;
  EXPECT_EQ(measurement, b.measurement);
  EXPECT_EQ(permit, b.permit);
  EXPECT_EQ(step, b.step);
  EXPECT_EQ(finish, b.finish);
  EXPECT_EQ(hold_still, b.hold_still);
  EXPECT_EQ(overruns, b.overruns);
}

TEST_F(ControllerLoopBench, CarriesEveryFieldToItsPlaceAndNoOther) {
  const auto carried = [&](const auto& base, const auto& place) {
    fields::for_each_field(base, [&](auto member, const auto& message) {
      using Message = std::remove_cvref_t<decltype(message)>;
      fake_bus::put(base);
      turn();
      robot::ControllerInputs expected = last();
      expected.measurement = next();
      place(expected, member, message);
      if constexpr (!std::is_same_v<Message, Measurement>) fake_bus::put(message);
      turn(expected.measurement);
      expect_same(expected, last());
    });
  };
  carried(fields::distinct<Permit>(100), [](auto& in, auto, const Permit& permit) { in.permit = permit; });
  carried(fields::distinct<Decision>(200), [](auto& in, auto member, const Decision& decision) {
    if (fields::same_member(member, &Decision::step)) in.step = decision.step;
  });
  carried(fields::distinct<OperatorAct>(300), [](auto& in, auto member, const OperatorAct& act) {
    if (fields::same_member(member, &OperatorAct::finish)) in.finish = act.finish;
    if (fields::same_member(member, &OperatorAct::hold_still)) in.hold_still = act.hold_still;
  });
  fields::for_each_field(fields::distinct<Measurement>(400), [&](auto, const Measurement& measured) {
    turn(measured);
    EXPECT_EQ(last().measurement, measured);
  });
}

TEST_F(ControllerLoopBench, CarriesTheValuesOfStepFinishAndHoldStill) {
  for (const bool on : {true, false}) {
    OperatorAct act;
    act.finish = on;
    act.hold_still = !on;
    Decision decision;
    decision.step = on ? 3 : 4;
    fake_bus::put(act);
    fake_bus::put(decision);
    turn();
    EXPECT_EQ(last().finish, on);
    EXPECT_EQ(last().hold_still, !on);
    EXPECT_EQ(last().step, on ? 3U : 4U);
  }
  turn();
  EXPECT_EQ(last().step, 4U) << "kept";
}

TEST_F(ControllerLoopBench, AnswersEveryMeasurementOnceAndNothingElse) {
  std::vector<std::uint32_t> answers, answered;  // to as many as the bus keeps
  for (std::uint32_t seq = 1; seq <= 16; ++seq) {
    Measurement measured;
    measured.seq = seq;
    fake_bus::put(measured);
    answers.push_back(1'000 + seq);
  }
  loop.turn(std::chrono::milliseconds(5));
  for (const DriveRequest& request : fake_bus::written<DriveRequest>()) answered.push_back(request.seq);
  EXPECT_EQ(answered, answers);
  loop.turn(std::chrono::milliseconds(5));
  EXPECT_TRUE(fake_bus::written<DriveRequest>().empty());
  EXPECT_EQ(fake_bus::state().waited.back(), std::chrono::milliseconds(5));
  EXPECT_EQ(calls.controller_config, kConfig);
}

TEST_F(ControllerLoopBench, CountsMeasurementsBeyondTwoAtOnceAsPeriodsThatItMissed) {
  std::uint32_t missed = 0;
  for (const std::uint32_t together : {1U, 2U, 3U, 6U}) {
    for (std::uint32_t n = 0; n < together; ++n) fake_bus::put(next());
    loop.turn(std::chrono::milliseconds(5));
    missed += together > 2 ? together - 2 : 0;
    EXPECT_EQ(loop.heartbeat().health().overruns, missed);
    turn();
    EXPECT_EQ(last().overruns, missed);
  }
  EXPECT_EQ(loop.heartbeat().lateness().count(), 8);
}

TEST_F(ControllerLoopBench, TakesAPlanAtRestOnlyAndSaysWhatItRuns) {
  const SealedPlan plan{7, {1, 2, 3}, {4}, {5, 6}};
  calls.plan_tag = 99;
  Permit permit;
  permit.hv_enable = true;
  fake_bus::put(permit);
  fake_bus::put(plan);
  turn();
  EXPECT_TRUE(calls.loaded.empty());
  EXPECT_FALSE(loop.heartbeat().health().ready);
  permit.hv_enable = false;
  fake_bus::put(permit);
  turn();
  ASSERT_EQ(calls.loaded.size(), 1U);
  EXPECT_EQ(calls.loaded.front(), plan);
  permit.mode = Mode::Ready;
  fake_bus::put(permit);
  fake_bus::put(plan);
  turn();
  ASSERT_EQ(calls.loaded.size(), 2U) << "another, ready or not";
  calls.loaded.pop_back();
  EXPECT_TRUE(loop.heartbeat().health().ready);
  EXPECT_EQ(loop.heartbeat().health().plan_tag, 99U);
  EXPECT_EQ(loop.heartbeat().health().note, "");
  turn();
  EXPECT_EQ(calls.loaded.size(), 1U) << "once";
  calls.plan_tag = 0;  // a broken seal
  fake_bus::put(plan);
  turn();
  EXPECT_FALSE(loop.heartbeat().health().ready);
  EXPECT_EQ(loop.heartbeat().health().plan_tag, 0U);
  EXPECT_EQ(loop.heartbeat().health().note, "the plan's seal does not hold");
}

TEST_F(ControllerLoopBench, SaysThatItLivesTenTimesASecond) {
  std::size_t sent = 0;
  Health health;
  for (int n = 0; n < 1'000; ++n) {
    fake_bus::set_clock_us(kStart_us + 1'000 * n);
    turn();
    for (const Health& each : fake_bus::written<Health>()) health = each, ++sent;
  }
  EXPECT_EQ(sent, 10U);
  EXPECT_EQ(health.process, Process::Controller);
  EXPECT_EQ(health.config_tag, kConfig);
}

TEST_F(ControllerLoopBench, WaitsForMeasurementsAndSaysHowLongItsAnswerTook) {
  loop.turn(std::chrono::milliseconds(5));
  EXPECT_EQ(fake_bus::state().watched, 1U);
  EXPECT_GE(fake_bus::state().now_ns, (kStart_us + 5'000) * 1'000) << "none came";
  EXPECT_EQ(loop.heartbeat().lateness().count(), 0U);
  const std::int64_t began_ns = fake_bus::state().now_ns;
  turn();
  EXPECT_LT(fake_bus::state().now_ns, began_ns + 1'000) << "one was there";
  EXPECT_EQ(loop.heartbeat().lateness().count(), 1U);
  EXPECT_EQ(loop.heartbeat().lateness().max_us(), 0);
  calls.control_ns = 700'000;
  turn();
  EXPECT_EQ(loop.heartbeat().lateness().max_us(), 700);
}

TEST_F(ControllerLoopBench, BeatsInMicrosecondsOfTheClock) {
  const auto beats = [&](std::int64_t us) {
    fake_bus::set_clock_us(kStart_us + us);
    turn();
    return fake_bus::written<Health>().size();
  };
  EXPECT_EQ(beats(0), 1U);
  EXPECT_EQ(beats(99'950), 0U);
  EXPECT_EQ(beats(100'000), 1U);
  EXPECT_EQ(beats(199'950), 0U);
  EXPECT_EQ(beats(200'000), 1U);
}

}  // namespace
}  // namespace biopsy::loops_tests
