// What a supervisor process can get wrong: which message, level or clock becomes which input. Inputs are made
// by hand, each with a value of its own, so that a field read from its neighbour shows.
#include "robot/cycle/supervise.hpp"

#include <gtest/gtest.h>

#include "robot/cycle/plan_facts.hpp"
#include "tests/robot/cycle/supervise_bench.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::robot {
namespace {

constexpr std::int64_t kActMax_us = 500'000;

TEST_F(Supervise, GivesEachFieldOfAnOperatorActToItsOwnInput) {
  in.act.message.token = 4;
  in.act.message.held = true;
  in.act.message.stop = StopCategory::C1Ramp;
  in.act.message.acquiring = false;
  in.act.message.hold_still = true;
  in.act.message.patient_motion_um = 321;
  const safety::SupervisorInputs given = inputs();
  EXPECT_EQ(given.motion.token, 4U);
  EXPECT_TRUE(given.motion.held);
  EXPECT_EQ(given.stop, StopCategory::C1Ramp);
  EXPECT_FALSE(given.acquiring);
  EXPECT_EQ(given.patient_motion_um, 321);
  EXPECT_FALSE(given.remote_arm || given.remote_reset || given.local_arm || given.local_reset);
  in.act.at_us += 1;
  in.act.message.arm = true;
  EXPECT_TRUE(inputs().remote_arm && !seen.inputs.remote_reset);
  in.act.at_us += 1;
  in.act.message.arm = false, in.act.message.reset = true;
  EXPECT_TRUE(inputs().remote_reset && !seen.inputs.remote_arm);
}

TEST_F(Supervise, CountsAPressOnceWhenItArrives) {
  in.act.message = {.seq = 1, .token = 9, .held = true, .stop = StopCategory::None, .arm = true};
  EXPECT_EQ(inputs().motion.token, 9U);
  in.now_us += 1'000;
  EXPECT_EQ(inputs().motion.token, 0U) << "nothing that is remembered holds a button";
  EXPECT_FALSE(seen.inputs.remote_arm);
  EXPECT_EQ(seen.inputs.stop, StopCategory::None) << "a level stays";
}

TEST_F(Supervise, HoldsWithoutAnOperator) {
  verifies("R-33");
  in.act.message.stop = StopCategory::None;
  in.act.message.acquiring = false;
  in.act.message.patient_motion_um = 0;
  in.now_us = in.act.at_us + kActMax_us;
  EXPECT_EQ(inputs().stop, StopCategory::None);
  in.now_us += 1;
  EXPECT_EQ(inputs().stop, StopCategory::C2Hold);
  EXPECT_TRUE(seen.inputs.acquiring);
  EXPECT_EQ(seen.inputs.patient_motion_um, safety::kUnknown);
  in.act.at_us = 0;
  in.now_us = 1'000;
  EXPECT_EQ(inputs().stop, StopCategory::C2Hold) << "never heard";
}

// Time in us after the sensor's message, what it says, what the images said; what the supervisor is given.
TEST_F(Supervise, TakesTheLargerOfWhatImagesAndASensorShowOfThePatient) {
  verifies("R-33");
  in.act.message.stop = StopCategory::None;
  const auto given = [this](std::int32_t image_um) {
    in.act.at_us = in.now_us;
    in.act.message.patient_motion_um = image_um;
    return inputs().patient_motion_um;
  };
  EXPECT_EQ(given(300), 300) << "no sensor was ever there";
  EXPECT_EQ(given(0), 0);
  in.navigation.message.patient_motion_um = 900;
  in.navigation.at_us = in.now_us;
  EXPECT_EQ(given(300), 300) << "it says that it does not measure";
  in.navigation.message.measures_patient = true;
  EXPECT_EQ(given(300), 900);
  EXPECT_EQ(given(1'700), 1'700);
  EXPECT_EQ(given(-1), safety::kUnknown);
  in.navigation.message.patient_motion_um = -1;
  EXPECT_EQ(given(300), safety::kUnknown);
}

// Three hundred milliseconds, three of its messages; and for ever, if it is another one that measures
// nothing.
TEST_F(Supervise, NeedsASensorOfThePatientFromTheFirstOnThatItHad) {
  verifies("R-33");
  in.act.message.stop = StopCategory::None;
  const auto given = [this] {
    in.act.at_us = in.now_us;
    in.act.message.patient_motion_um = 0;
    return inputs().patient_motion_um;
  };
  in.navigation = {{.seq = 1, .measures_patient = true, .patient_motion_um = 50}, in.now_us};
  const std::int64_t came_us = in.now_us;
  EXPECT_EQ(given(), 50);
  in.now_us = came_us + 300'000;
  EXPECT_EQ(given(), 50);
  in.now_us += 1;
  EXPECT_EQ(given(), safety::kUnknown);
  in.navigation = {{.seq = 2, .measures_patient = false, .patient_motion_um = 0}, in.now_us};
  EXPECT_EQ(given(), safety::kUnknown) << "its program was started anew";
  in.navigation = {{.seq = 3, .measures_patient = true, .patient_motion_um = 20}, in.now_us};
  EXPECT_EQ(given(), 20);
}

TEST_F(Supervise, AgesTheLogsBacklog) {
  verifies("R-28");
  in.log.message.backlog_ms = 40;
  EXPECT_EQ(inputs().log_backlog_ms, 40);
  in.now_us += 960'000;
  EXPECT_EQ(inputs().log_backlog_ms, 1'000);
  in.log.message.backlog_ms = safety::kUnknown;
  EXPECT_EQ(inputs().log_backlog_ms, safety::kUnknown) << "no overflow";
  in.log = {{.backlog_ms = 0}, kNow_us - 2'000'000};
  in.now_us = kNow_us;
  EXPECT_EQ(inputs().log_backlog_ms, 2'000);
  in.log.at_us = 1;
  EXPECT_EQ(inputs().log_backlog_ms, 9'999) << "heard in the first microsecond";
  in.log.at_us = 0;
  EXPECT_EQ(inputs().log_backlog_ms, safety::kUnknown) << "never heard";
}

TEST_F(Supervise, NeedsTheSealedPlanInTheController) {
  verifies("R-12");
  EXPECT_EQ(inputs().plan_tag, planner::plan_tag(plan));
  for (std::size_t byte = 0; byte < plan.seal.size(); ++byte) {  // behind the eighth both plans have one tag
    in.request.plan_seal = plan.seal;
    in.request.plan_seal[byte] ^= 1;
    EXPECT_EQ(inputs().plan_tag, 0U) << "byte " << byte;
  }
}

TEST_F(Supervise, NeedsOneConfigurationInAllThreeProcesses) {
  verifies("R-13");
  EXPECT_EQ(inputs().config_tag, kConfig);
  in.measurement.config_tag = kConfig + 1;
  EXPECT_EQ(inputs().config_tag, 0U);
  for (const std::uint64_t other : {std::uint64_t{0}, kConfig - 1, kConfig + 1}) {
    in.measurement.config_tag = kConfig, in.request.config_tag = other;
    EXPECT_EQ(inputs().config_tag, 0U);
    in.measurement.config_tag = other, in.request.config_tag = kConfig;
    EXPECT_EQ(inputs().config_tag, 0U);
  }
}

TEST_F(Supervise, FilesThatChangedSinceTheStartKeepItFromBeingArmedAndDoNotStopWhatMoves) {
  verifies("R-13");
  for (const std::uint64_t files : {kConfig + 1, std::uint64_t{0}}) {
    in.files_tag = files;
    for (const Mode mode : {Mode::Boot, Mode::Safe, Mode::Ready, Mode::Trip, Mode::Lock}) {
      memory.state.mode = mode;
      EXPECT_EQ(inputs().config_tag, 0U) << safety::name_of(mode);
    }
    for (const Mode mode : {Mode::Armed, Mode::Active, Mode::Hold, Mode::Retract}) {
      memory.state.mode = mode;
      EXPECT_EQ(inputs().config_tag, kConfig) << safety::name_of(mode);
    }
  }
}

TEST_F(Supervise, TakesADepthVerdictOfThisPlanOnly) {
  memory.permit.seq = 5'000;
  const std::uint64_t tag = planner::plan_tag(plan);
  in.verdict = {.seq = 9, .plan_tag = tag, .step = 1, .accepted = true, .session = 6, .since_seq = 4'321};
  EXPECT_TRUE(inputs().depth_accepted);
  EXPECT_EQ(seen.inputs.accepted_step, 1U);
  EXPECT_EQ(seen.inputs.accepted_session, 6U);
  EXPECT_EQ(seen.inputs.accepted_since_seq, 4'321U);
  in.verdict.accepted = false;
  EXPECT_FALSE(inputs().depth_accepted);
  in.verdict.accepted = true;
  for (const std::uint64_t other : {tag - 1, tag + 1}) {
    in.verdict.plan_tag = other;
    EXPECT_FALSE(inputs().depth_accepted);
  }
  in.verdict = {.seq = 2, .plan_tag = 0, .step = 0, .accepted = true};
  memory.plan = {};
  EXPECT_FALSE(inputs().depth_accepted) << "without a plan";
}

TEST_F(Supervise, PassesOnWhatItIssuedMeasuredAndWasRequested) {
  in.measurement.depth_um = 1'234;
  in.request.seq = 17;
  in.writers = 2;
  memory.permit.seq = 99;
  EXPECT_EQ(inputs().permit.seq, 99U);
  EXPECT_EQ(seen.inputs.measurement.depth_um, 1'234);
  EXPECT_EQ(seen.inputs.request.seq, 17U);
  EXPECT_EQ(seen.inputs.writers, 2);
  EXPECT_EQ(seen.inputs.now_us, kNow_us);
  EXPECT_EQ(seen.inputs.self_test, safety::SelfTest::Passed);
  const Permit issued = supervise(in, memory, &seen).output.permit;
  EXPECT_NE(issued.seq, 99U);
  EXPECT_EQ(inputs().permit, issued) << "that of the last tick";
}

TEST_F(Supervise, AcceptsAPlanAtRestAndNoticesOneInMotion) {
  verifies("R-12");
  Plan other = plan;
  other.target_depth = Millimetres(2.5);
  planner::seal(other);
  memory.state.mode = Mode::Active;
  accept_plan(sealed(other), memory);
  EXPECT_EQ(memory.plan.plan_tag, planner::plan_tag(plan));
  EXPECT_EQ(inputs().plan_tag, 0U);
  memory.state.mode = Mode::Safe;
  accept_plan(sealed(other), memory);
  EXPECT_EQ(memory.plan.plan_tag, planner::plan_tag(other));
  EXPECT_EQ(memory.confirmed_tag, sealed(other).confirmed_tag);
}

TEST_F(Supervise, HasNoPlanWhereTheSealIsBrokenOrStepsDoNotFit) {
  verifies("R-12");
  SealedPlan broken = sealed(plan);
  broken.seal[3] ^= 1;
  accept_plan(broken, memory);
  EXPECT_EQ(memory.plan.plan_tag, 0U);
  EXPECT_EQ(memory.sealed_tag, 0U);
  Plan many = plan;
  const auto is_taken = [&] {
    planner::seal(many);
    accept_plan(sealed(many), memory);
    return memory.plan.plan_tag == planner::plan_tag(many);
  };
  many.steps.resize(safety::kMaxSteps, plan.steps.front());
  many.limits.plausible.resize(safety::kMaxBands, plan.limits.plausible.back());
  EXPECT_TRUE(is_taken()) << "as many as there is room for";
  many.limits.plausible.push_back(plan.limits.plausible.back());
  EXPECT_FALSE(is_taken());
  EXPECT_EQ(memory.plan.plan_tag, 0U);
  many.limits.plausible.pop_back();
  many.steps.push_back(plan.steps.front());
  EXPECT_FALSE(is_taken());
  EXPECT_EQ(memory.plan.plan_tag, 0U);
}

// Fault injection relies on it: once with what the monitors get, once with what they found.
TEST_F(Supervise, ShowsAFaultWhatTheDecisionIsMadeFrom) {
  struct Stops final : FaultHooks {
    void before_decision(safety::SupervisorInputs&, safety::Evidence& evidence) override {
      evidence.clear &= ~safety::bit(safety::Hazard::Arc);
    }
  } stops;
  EXPECT_EQ(supervise(in, memory, &stops).evidence.clear & safety::bit(safety::Hazard::Arc), 0U);
}

TEST(CauseOf, IsTheHazardAndWithoutOneTheEvent) {
  safety::SupervisorOutput output;
  output.reason = safety::Hazard::PopThrough, output.worst = safety::Hazard::Arc;
  output.event = safety::Event::Fault;
  EXPECT_EQ(cause_of(output, kSeenPressed), safety::name_of(safety::Hazard::PopThrough));
  output.reason = safety::Hazard::ResidualCharge;
  EXPECT_EQ(cause_of(output, kSeenPressed), safety::name_of(safety::Hazard::ResidualCharge));
  output.reason = safety::Hazard::None;
  EXPECT_EQ(cause_of(output, kSeenPressed), "an immediate stop was asked for");
  for (const safety::Event event : {safety::Event::Stop, safety::Event::VoltagePresent}) {
    output.event = event;
    EXPECT_EQ(cause_of(output, kSeenPressed), safety::name_of(event));
  }
}

TEST(WriterCount, IsOneOnlyWhereEveryTopicIsRight) {
  verifies("R-11");
  const WriterCounts right{.measurements = 1,
                           .requests = 1,
                           .acts = 1,
                           .measurements_alive = 1,
                           .requests_alive = 1,
                           .plans = 1,
                           .verdicts = 1,
                           .log = 1};
  EXPECT_EQ(writer_count(right), 1);
  std::int32_t WriterCounts::*const needed[] = {&WriterCounts::measurements, &WriterCounts::requests,
                                                &WriterCounts::acts, &WriterCounts::measurements_alive,
                                                &WriterCounts::requests_alive};
  for (const auto field : needed)
    for (const std::int32_t wrong : {0, 2, -1}) {
      WriterCounts counts = right;
      counts.*field = wrong;
      EXPECT_NE(writer_count(counts), 1) << wrong;
      const bool alive = field == &WriterCounts::measurements_alive || field == &WriterCounts::requests_alive;
      EXPECT_EQ(writer_count(counts), alive ? 0 : wrong) << "which shows in the supervisor's inputs";
    }
  std::int32_t WriterCounts::*const optional[] = {&WriterCounts::plans, &WriterCounts::verdicts,
                                                  &WriterCounts::log};
  for (const auto field : optional) {
    WriterCounts counts = right;
    counts.*field = 0;
    EXPECT_EQ(writer_count(counts), 1) << "nothing is permitted for want of it";
    counts.*field = 2;
    EXPECT_EQ(writer_count(counts), 2);
  }
  WriterCounts at_rest = right;
  at_rest.plans = at_rest.verdicts = at_rest.log = 0;
  EXPECT_EQ(writer_count(at_rest), 1);
}

}  // namespace
}  // namespace biopsy::robot
