// No hazard without a producer. Each is made from what reaches the supervisor in the product, live and in
// lockstep alike: messages of the bus, the panel, the writers, the files and the clock (SupervisorSources),
// and the plan that is sent. Nothing is put into the monitors' inputs. The same ticks without the change name
// no hazard at all.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>

#include "planner/plan/seal.hpp"
#include "robot/cycle/supervise.hpp"
#include "safety/challenge.hpp"
#include "safety/types/transitions.hpp"
#include "tests/robot/cycle/small_plan.hpp"

namespace biopsy::robot {
namespace {

using safety::Hazard;

constexpr std::uint64_t kConfigTag = 77;
constexpr std::int32_t kDrive_mV = 3'000'000, kHalfPeriod_ticks = 250, kDepth_um = 1'000;
constexpr int kSettled_ticks = 1'200, kMost_ticks = 4'000;

Plan one_step() {
  return small_plan({3.0}, {{Volts(0), Millimetres(-0.5), Millimetres(3.5)},
                            {Volts(8000), Millimetres(2.0), Millimetres(6.0)}});
}

// A healthy supervisor in a mode that the test holds, whatever it decides, so that a hazard can be watched.
struct Chain {
  explicit Chain(Mode in) : mode(in) {
    memory.config_tag = kConfigTag;
    memory.self_test = safety::SelfTest::Passed;
    memory.state = safety::started(1);
    assume_tested_panel(memory);
    send(one_step());
    sources.writers = 1;
    sources.files_tag = kConfigTag;
    sources.panel = {{.estop_a_closed = true, .estop_b_closed = true}, true};
    sources.act.message.stop = StopCategory::None;
    sources.act.message.acquiring = false;
    Measurement& m = sources.measurement;
    m.depth_um = m.depth_b_um = kDepth_um;
    m.laser_valid = m.laser_b_valid = true;
    m.config_tag = sources.request.config_tag = kConfigTag;
  }
  void send(const Plan& plan) {
    const std::uint64_t tag = planner::plan_tag(plan);
    accept_plan({1, planner::canonical_bytes(plan), plan.seal, {tag, tag}}, memory);
    sources.request.plan_seal = plan.seal;
  }
  bool runs() const { return safety::hv_permitted(mode); }

  safety::HazardSet tick(const std::function<void(Chain&)>& change) {
    ++ticks;
    sources.now_us += 1'000;
    sources.act.at_us = sources.log.at_us = sources.now_us;
    Measurement& m = sources.measurement;
    ++m.seq, ++m.laser_code, m.time_us += 1'000;
    m.hv_enabled = runs();
    m.command_mV = m.monitor_mV = !runs() ? 0 : ticks / kHalfPeriod_ticks % 2 == 0 ? kDrive_mV : -kDrive_mV;
    if (!runs()) m.depth_um = m.depth_b_um = 0;
    m.answered_seq = memory.permit.seq;
    m.answer = safety::answer_to(safety::challenge_of(memory.permit.session, m.answered_seq), m.command_mV,
                                 memory.permit.mode, m.answered_seq);
    ++sources.request.seq;
    sources.panel.levels.relay_closed = memory.permit.seq > 0 && runs();
    if (change) change(*this);
    const safety::HazardSet found = supervise(sources, memory).evidence.hazards();
    memory.permit = {.session = 1,
                     .epoch = 1,
                     .seq = memory.permit.seq + 1,
                     .mode = mode,
                     .hv_enable = runs(),
                     .v_max_mV = 5'000'000,
                     .depth_max_um = 3'500};
    memory.state.mode = mode;
    return found;
  }

  Mode mode;
  SupervisorMemory memory;
  SupervisorSources sources;
  int ticks = 0;
};

struct Producer {
  std::function<void(Chain&)> change;  // in each tick from when it settled on
  Mode in = Mode::Active;
};

void show_depth(Chain& chain, std::int32_t depth_um) {
  chain.sources.measurement.depth_um = chain.sources.measurement.depth_b_um = depth_um;
}

std::int32_t since(const Chain& chain) {
  return chain.ticks - kSettled_ticks;
}

// What no robot of this kind can mean: a target of a metre.
Plan absurd() {
  Plan plan = one_step();
  plan.limits.depth_max = plan.target_depth = plan.steps[0].depth = Millimetres(1'000.0);
  planner::seal(plan);
  return plan;
}

const std::map<Hazard, Producer>& producers() {
  static const std::map<Hazard, Producer> all{
      {Hazard::ResidualCharge, {[](Chain& c) { c.sources.measurement.monitor_mV = 150'000; }, Mode::Safe}},
      {Hazard::NeedleNotBack, {[](Chain& c) { show_depth(c, 1'200); }, Mode::Safe}},
      {Hazard::EStop, {[](Chain& c) { c.sources.panel.read = false; }}},
      {Hazard::EStopDisagrees, {[](Chain& c) { c.sources.panel.levels.estop_b_closed = false; }}},
      {Hazard::ClockJump, {[](Chain& c) { c.sources.now_us += 6'000; }}},
      {Hazard::OverVoltage, {[](Chain& c) { c.sources.measurement.monitor_mV = 8'300'000; }}},
      {Hazard::Arc, {[](Chain& c) { c.sources.measurement.current_nA = 50'000'000; }}},
      {Hazard::MonitorDisagrees, {[](Chain& c) { c.sources.measurement.monitor_mV /= 2; }}},
      {Hazard::DriverDisobeys, {[](Chain& c) { c.sources.measurement.brake_on = true; }}},
      {Hazard::WrongAnswer, {[](Chain& c) { c.sources.measurement.answer ^= 1U; }}},
      {Hazard::SecondWriter, {[](Chain& c) { c.sources.writers = 2; }}},
      {Hazard::ControllerSilent, {[](Chain& c) { c.sources.request.seq = 1'000; }}},
      {Hazard::PlanChanged, {[](Chain& c) { c.sources.request.plan_seal[31] ^= 1U; }}},
      {Hazard::ConfigChanged, {[](Chain& c) { c.sources.files_tag ^= 1U; }, Mode::Safe}},
      {Hazard::HardOverDepth, {[](Chain& c) { show_depth(c, 5'100); }}},
      {Hazard::FastDrop, {[](Chain& c) { show_depth(c, kDepth_um - 100 * since(c)); }}},
      {Hazard::InterlockStuck, {[](Chain& c) { c.sources.panel.levels.relay_closed = false; }}},
      {Hazard::OverDepth, {[](Chain& c) { show_depth(c, 4'100); }}},
      {Hazard::PopThrough, {[](Chain& c) { show_depth(c, kDepth_um + 900); }}},
      {Hazard::SensorStale, {[](Chain& c) { c.sources.measurement.seq = 1'000; }}},
      {Hazard::SensorFrozen, {[](Chain& c) {
         c.sources.measurement.laser_code = 5;
         c.sources.measurement.command_mV = c.sources.measurement.monitor_mV = since(c) * 20'000;
       }}},
      {Hazard::LaserDropout, {[](Chain& c) { c.sources.measurement.laser_b_valid = false; }}},
      {Hazard::OffsetOrScale, {[](Chain& c) { c.sources.measurement.depth_b_um += 400 + since(c); }}},
      {Hazard::PolarityStuck,
       {[](Chain& c) { c.sources.measurement.command_mV = c.sources.measurement.monitor_mV = kDrive_mV; }}},
      {Hazard::WrongFrequency, {[](Chain& c) {
         c.sources.measurement.command_mV = c.sources.measurement.monitor_mV =
             c.ticks / 100 % 2 == 0 ? kDrive_mV : -kDrive_mV;
       }}},
      {Hazard::LoopOverrun, {[](Chain& c) { ++c.sources.request.overruns; }}},
      {Hazard::MessageOrder, {[](Chain& c) { c.sources.measurement.seq += 3; }}},
      {Hazard::WrongTissueModel, {[](Chain& c) { show_depth(c, -1'200); }}},
      {Hazard::LogBacklog, {[](Chain& c) { c.sources.log.message.backlog_ms = 1'100; }}},
      {Hazard::PlanImplausible, {[](Chain& c) { c.send(absurd()); }, Mode::Safe}},
      {Hazard::PlanUnconfirmed,
       {[](Chain& c) {
          const Plan plan = one_step();
          accept_plan({2, planner::canonical_bytes(plan), plan.seal, {planner::plan_tag(plan), 0}}, c.memory);
        },
        Mode::Safe}},
      {Hazard::PanelUntested, {[](Chain& c) { c.sources.now_us += 25LL * 3'600 * 1'000'000; }, Mode::Safe}},
      {Hazard::StepDepth, {[](Chain& c) { show_depth(c, 3'600); }}},
      {Hazard::SuspectTissueModel, {[](Chain& c) { show_depth(c, -1'200); }}},
      {Hazard::PatientMotion, {[](Chain& c) { c.sources.act.message.patient_motion_um = 2'100; }}}};
  return all;
}

class EveryHazardOfTheTable : public testing::TestWithParam<safety::HazardFacts> {};

TEST_P(EveryHazardOfTheTable, HasAProducerOutsideTheSupervisor) {
  const Hazard hazard = GetParam().hazard;
  const auto found = producers().find(hazard);
  ASSERT_NE(found, producers().end()) << GetParam().name << " has no producer";
  Chain chain(found->second.in);
  for (int i = 0; i < kSettled_ticks; ++i) {
    const safety::HazardSet named = chain.tick({});
    if (i < kSettled_ticks / 2) continue;  // at the start nothing is known yet
    ASSERT_EQ(named, 0U) << "without it: " << safety::name_of(safety::worst_of(named)) << " in tick " << i;
  }
  int ticks = 0;
  while (ticks < kMost_ticks && (chain.tick(found->second.change) & safety::bit(hazard)) == 0) ++ticks;
  EXPECT_LT(ticks, kMost_ticks) << GetParam().name;
}

INSTANTIATE_TEST_SUITE_P(All, EveryHazardOfTheTable, testing::ValuesIn(safety::kHazardTable),
                         [](const auto& tested) {
                           std::string name(tested.param.requirement);
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace biopsy::robot
