// The scripted operator against robots that answer late: over a bus a tick is read after others were made,
// and a press takes some milliseconds to be followed. The robots here are made by hand and know nothing of
// the script.
#include "robot/procedure/operator.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <map>

namespace biopsy::robot {
namespace {

// A robot reduced to its modes. What it is given arrives `delay` ticks later; a step is done after 50 ticks
// of motion.
class DelayedRobot {
 public:
  DelayedRobot(std::uint32_t steps, std::size_t delay)
      : steps_(steps), on_the_way_(delay, OperatorInputs::idle()) {}

  bool brake_fitted = false;
  int arms_refused = 0;                         // the next ones: a hazard was there in that very tick
  safety::Hazard worst = safety::Hazard::None;  // named from here on

  CycleRecord tick(const OperatorInputs& inputs) {
    on_the_way_.push_back(inputs);
    const OperatorInputs now = on_the_way_.front();
    on_the_way_.pop_front();
    const bool pressed = now.press.held && now.press.token > token_;
    token_ = std::max(token_, now.press.token);
    if (mode_ == Mode::Boot) mode_ = Mode::Ready;
    const bool arms = now.arm && !arm_was_down_;
    arm_was_down_ = now.arm;
    if (mode_ == Mode::Ready && arms && --arms_refused < 0) mode_ = Mode::Armed;
    if (mode_ == Mode::Armed && pressed) start();
    if (mode_ == Mode::Hold && pressed && done_ && now.depth_accepted && now.accepted_step == step_ &&
        step_ + 1 < steps_)
      ++step_, start();
    if (mode_ == Mode::Active && ++moving_ > 50) mode_ = Mode::Hold, done_ = true;
    if (now.finish && (mode_ == Mode::Active || mode_ == Mode::Hold)) mode_ = Mode::Ready;
    CycleRecord record;
    record.supervisor.permit.mode = mode_;
    record.supervisor.worst = worst;
    record.supervisor.step = step_;
    record.supervisor.step_done = done_;
    record.measurement.brake_fitted = brake_fitted;
    record.measurement.brake_on = brake_fitted && mode_ == Mode::Hold && (now.hold_still || locked_);
    locked_ = record.measurement.brake_on;
    unloading_ = locked_ ? unloading_ + 1 : 0;
    record.drive_mV = mode_ == Mode::Hold && unloading_ < 350 ? 3'000'000 : 0;
    return record;
  }

 private:
  void start() {
    mode_ = Mode::Active;
    moving_ = 0;
    done_ = false;
  }
  std::uint32_t steps_;
  std::deque<OperatorInputs> on_the_way_;
  Mode mode_ = Mode::Boot;
  std::uint32_t step_ = 0, token_ = 0;
  int moving_ = 0, unloading_ = 0;
  bool done_ = false, locked_ = false, arm_was_down_ = false;
};

struct Procedure {
  bool completed = false;
  std::string stopped_because;
  std::map<std::uint32_t, int> images;  // of each step
};

// As rehearse_on() does: a check takes as long as `queued` ticks, which then wait to be read.
Procedure rehearse(std::uint32_t steps, std::size_t delay, std::size_t queued,
                   const std::function<DepthVerdict(std::uint32_t step, int image)>& verdict) {
  Plan plan;
  plan.steps.resize(steps);
  for (InsertionStep& step : plan.steps) step.image_confirms = true;
  Operator script(plan, kFastScan);
  DelayedRobot robot(steps, delay);
  std::deque<CycleRecord> waiting;
  Procedure procedure;
  OperatorInputs inputs;
  CycleRecord seen;
  for (std::int64_t number = 0; number < 200'000 && !script.done(); ++number) {
    if (waiting.empty()) inputs = script.act(seen, number);
    if (script.wants_verdict()) {
      const std::uint32_t step = inputs.accepted_step;
      script.judge(verdict(step, ++procedure.images[step]), "a reason");
      for (std::size_t i = 0; i < queued; ++i) waiting.push_back(robot.tick(inputs));
    }
    if (waiting.empty()) waiting.push_back(robot.tick(inputs));  // the queue is read faster than ticks come
    seen = waiting.front();
    waiting.pop_front();
    script.observe(seen);
  }
  procedure.completed = script.completed();
  procedure.stopped_because = script.stopped_because();
  return procedure;
}

DepthVerdict always_accept(std::uint32_t, int) {
  return DepthVerdict::Accept;
}

TEST(Operator, TakesOneImageOfEachStepHoweverLateTicksAre) {
  for (const std::uint32_t steps : {1U, 2U, 3U, 5U})
    for (const std::size_t delay : {0U, 1U, 7U, 40U, 150U})
      for (const std::size_t queued : {0U, 3U, 900U, 2'500U}) {
        const Procedure procedure = rehearse(steps, delay, queued, always_accept);
        EXPECT_TRUE(procedure.completed) << steps << " steps, " << delay << " late, " << queued
                                         << " queued: " << procedure.stopped_because;
        ASSERT_EQ(procedure.images.size(), steps);
        for (const auto& [step, images] : procedure.images) EXPECT_EQ(images, 1) << "step " << step;
      }
}

// Of a stage with a brake: when the image began and how long it took, in ticks.
TEST(Operator, TakesTheImageOfALockedNeedleOnceItIsQuietAndForAsLongAsTheScannerTakes) {
  Plan plan;
  plan.steps.resize(2);
  for (InsertionStep& step : plan.steps) step.image_confirms = true;
  for (const double scan_s : {2.0, 60.0}) {
    Operator script(plan, Seconds(scan_s));
    DelayedRobot robot(2, 7);
    robot.brake_fitted = true;
    CycleRecord seen;
    int images = 0;
    std::int64_t begun = 0;
    bool before = false;
    for (std::int64_t number = 0; number < 300'000 && !script.done(); ++number) {
      const OperatorInputs inputs = script.act(seen, number);
      if (inputs.acquiring && !before) {
        begun = number;
        EXPECT_TRUE(is_quiet(seen));
      }
      EXPECT_TRUE(!inputs.acquiring || (inputs.hold_still && seen.drive_mV == 0));
      before = inputs.acquiring;
      if (script.wants_verdict()) {
        ++images;
        EXPECT_EQ(number - begun, static_cast<std::int64_t>(scan_s * 1e3));
        script.judge(DepthVerdict::Accept, "");
        before = false;
      }
      seen = robot.tick(inputs);
      script.observe(seen);
    }
    EXPECT_TRUE(script.completed()) << script.stopped_because();
    EXPECT_EQ(images, 2);
  }
}

TEST(Operator, RepeatsAnUnsureImageOnce) {
  for (const std::size_t delay : {0U, 7U}) {
    const Procedure second_time = rehearse(2, delay, 900, [](std::uint32_t step, int image) {
      return step == 1 && image == 1 ? DepthVerdict::Unsure : DepthVerdict::Accept;
    });
    EXPECT_TRUE(second_time.completed) << second_time.stopped_because;
    EXPECT_EQ(second_time.images.at(0), 1);
    EXPECT_EQ(second_time.images.at(1), 2);
    const Procedure never = rehearse(2, delay, 900, [](std::uint32_t, int) { return DepthVerdict::Unsure; });
    EXPECT_FALSE(never.completed);
    EXPECT_EQ(never.stopped_because, "a reason");
    EXPECT_EQ(never.images.at(0), 2);
    EXPECT_EQ(never.images.size(), 1U);
  }
}

TEST(Operator, ArmsAgainAfterARefusalAndSaysSoWhereItIsNeverArmed) {
  const auto ends = [](int refused, std::int64_t hazard_until = 0) {
    Plan plan;
    plan.steps.resize(1);
    Operator script(plan, kFastScan);
    DelayedRobot robot(1, 7);
    robot.arms_refused = refused;
    CycleRecord seen;
    for (std::int64_t number = 0; number < 20'000 && !script.done(); ++number) {
      const OperatorInputs inputs = script.act(seen, number);
      robot.worst = inputs.arm && number < hazard_until ? safety::Hazard::LoopOverrun : safety::Hazard::None;
      seen = robot.tick(inputs);
      script.observe(seen);
    }
    EXPECT_TRUE(script.done());
    return script.completed() ? "completed" : script.stopped_because();
  };
  EXPECT_EQ(ends(1), "completed");
  EXPECT_EQ(ends(4), "completed");
  EXPECT_EQ(ends(1'000), "arming was refused 6 times; last by: no hazard that was told");
  EXPECT_EQ(ends(1'000, 1'000), "arming was refused 6 times; last by: " +
                                    std::string(safety::name_of(safety::Hazard::LoopOverrun)))
      << "a hazard of a moment, gone when the operator gives up";
}

TEST(Operator, WithdrawsAfterARejectedImage) {
  const Procedure procedure = rehearse(2, 7, 900, [](std::uint32_t, int) { return DepthVerdict::Reject; });
  EXPECT_FALSE(procedure.completed);
  EXPECT_EQ(procedure.images.at(0), 1);
  EXPECT_EQ(procedure.stopped_because, "a reason");
}

// What the supervisor names in a tick of the hold: while the image is taken, and between its verdict and the
// next press.
TEST(Operator, AcceptsNoDepthOfAPatientWhoMovesWhileTheNeedleIsHeld) {
  enum class When : std::uint8_t { Image, Verdict, Never };
  for (const std::uint32_t steps : {1U, 2U})
    for (const bool image_confirms : {true, false})
      for (const When when : {When::Image, When::Verdict, When::Never}) {
        if (!image_confirms && when == When::Image) continue;  // there is none
        Plan plan;
        plan.steps.resize(steps);
        for (InsertionStep& step : plan.steps) step.image_confirms = image_confirms;
        Operator script(plan, kFastScan);
        DelayedRobot robot(steps, 7);
        CycleRecord seen;
        bool judged = false;
        for (std::int64_t number = 0; number < 50'000 && !script.done(); ++number) {
          const OperatorInputs inputs = script.act(seen, number);
          const bool held = seen.supervisor.permit.mode == Mode::Hold;
          judged = judged || (held && !image_confirms);
          const bool now =
              (when == When::Image && inputs.acquiring) || (when == When::Verdict && judged && held);
          robot.worst = now ? safety::Hazard::PatientMotion : safety::Hazard::None;
          if (script.wants_verdict()) script.judge(DepthVerdict::Accept, ""), judged = true;
          seen = robot.tick(inputs);
          script.observe(seen);
        }
        ASSERT_TRUE(script.done());
        const bool moved = when != When::Never && (image_confirms || steps > 1);
        EXPECT_EQ(script.completed(), !moved) << steps << ' ' << image_confirms << ' ' << int(when);
        EXPECT_EQ(script.stopped_because().find("the patient moved by more than 2 mm") == 0, moved)
            << script.stopped_because();
      }
}

// Found in real time: a hazard ramped the needle down within a scan, and the image of where it lay then was
// given as the reason.
TEST(Operator, NamesTheRampThatEndedItsImageThoughItIsOverBeforeTheOperatorActsAgain) {
  Plan plan;
  plan.steps.resize(1);
  plan.steps[0].image_confirms = true;
  Operator script(plan, kFastScan);
  DelayedRobot robot(1, 0);
  CycleRecord seen;
  for (std::int64_t number = 0; number < 20'000 && !script.wants_verdict(); ++number) {
    seen = robot.tick(script.act(seen, number));
    script.observe(seen);
  }
  ASSERT_TRUE(script.wants_verdict());
  seen.supervisor.permit.mode = Mode::Retract;
  seen.supervisor.reason = safety::Hazard::SensorStale;
  script.observe(seen);
  seen.supervisor.permit.mode = Mode::Safe;
  script.observe(seen);
  script.judge(DepthVerdict::Reject, "depth check: the tip is short");
  EXPECT_EQ(script.stopped_because(), "retract: H-08 no new measurement");
  EXPECT_FALSE(script.completed());
}

}  // namespace
}  // namespace biopsy::robot
