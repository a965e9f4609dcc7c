// Hazard by hazard: each fault is put into a healthy run at full drive; the evidence names it within its
// time, and the supervisor stops as the table says.
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

#include "safety/types/thresholds.hpp"
#include "tests/safety/rig.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

struct Fault {
  Hazard hazard;
  void (*inject)(Rig&);
  Mode in = Mode::Active;
};

// Holds the laser at a depth that moves away from the true one.
void move_depth(Rig& rig, std::int32_t um_per_tick, std::int32_t most_um) {
  rig.on_measurement = [um_per_tick, most_um, um = 0](Measurement& m) mutable {
    if (std::abs(um) < std::abs(most_um)) um += um_per_tick;
    m.depth_um += um;
  };
}

const Fault kFaults[] = {
    {Hazard::ResidualCharge,
     [](Rig& r) { r.on_measurement = [](Measurement& m) { m.monitor_mV = 150'000; }; }, Mode::Trip},
    {Hazard::NeedleNotBack, [](Rig& r) { r.on_measurement = [](Measurement& m) { m.depth_um = 1'100; }; },
     Mode::Trip},
    {Hazard::EStop, [](Rig& r) { r.on_observation = [](SupervisorInputs& s) { s.estop_b_closed = false; }; }},
    {Hazard::EStopDisagrees,
     [](Rig& r) { r.on_observation = [](SupervisorInputs& s) { s.estop_a_closed = false; }; }},
    {Hazard::ClockJump, [](Rig& r) { r.on_observation = [](SupervisorInputs& s) { s.now_us += 4'001; }; }},
    {Hazard::OverVoltage,
     [](Rig& r) { r.on_measurement = [](Measurement& m) { m.monitor_mV = -8'200'001; }; }},
    {Hazard::Arc, [](Rig& r) { r.on_measurement = [](Measurement& m) { m.current_nA = 5'000'000; }; }},
    {Hazard::MonitorDisagrees,
     [](Rig& r) { r.on_measurement = [](Measurement& m) { m.monitor_mV = m.monitor_mV / 100 * 95; }; }},
    {Hazard::DriverDisobeys, [](Rig& r) { r.on_measurement = [](Measurement& m) { m.hv_enabled = false; }; }},
    {Hazard::WrongAnswer, [](Rig& r) { r.on_measurement = [](Measurement& m) { m.answer ^= 1; }; }},
    {Hazard::SecondWriter, [](Rig& r) { r.on_observation = [](SupervisorInputs& s) { s.writers = 2; }; }},
    {Hazard::PlanChanged, [](Rig& r) { r.on_observation = [](SupervisorInputs& s) { s.plan_tag ^= 1; }; }},
    {Hazard::ConfigChanged,
     [](Rig& r) { r.on_observation = [](SupervisorInputs& s) { s.config_tag ^= 1; }; }},
    {Hazard::HardOverDepth, [](Rig& r) { move_depth(r, 2'100, 2'100); }},
    {Hazard::FastDrop, [](Rig& r) { move_depth(r, -60, -2'000); }},
    {Hazard::InterlockStuck,
     [](Rig& r) { r.on_observation = [](SupervisorInputs& s) { s.relay_closed = false; }; }},
    {Hazard::OverDepth, [](Rig& r) { move_depth(r, 1'100, 1'100); }},
    {Hazard::PopThrough, [](Rig& r) { r.wanted_mV = 5'000'000, r.run(900), move_depth(r, 125, 1'000); }},
    {Hazard::SensorStale,
     [](Rig& r) { r.on_measurement = [old = r.measurement](Measurement& m) { m = old; }; }},
    {Hazard::SensorFrozen,
     [](Rig& r) {
       r.wanted_mV = 5'500'000;
       r.on_measurement = [old = r.measurement](Measurement& m) {
         m.laser_code = old.laser_code, m.depth_um = old.depth_um;
       };
     }},
    {Hazard::LaserDropout, [](Rig& r) { r.on_measurement = [](Measurement& m) { m.laser_valid = false; }; }},
    {Hazard::OffsetOrScale,
     [](Rig& r) { r.wanted_mV = 4'000'000, r.run(900), move_depth(r, 15, 1'400), r.run(87); }},
    // Changes twice in half a second as it must, and is positive in nine tenths of it.
    {Hazard::PolarityStuck,
     [](Rig& r) {
       r.press();
       r.on_request = [tick = 0](DriveRequest& q) mutable {
         q.wanted_mV = (tick++ % 500 < 440 ? 1 : -1) * std::abs(q.wanted_mV);
       };
     },
     Mode::Armed},
    {Hazard::WrongFrequency, [](Rig& r) { r.flip_ticks = 190; }},
    {Hazard::LoopOverrun, [](Rig& r) { r.on_request = [](DriveRequest& q) { ++q.overruns; }; }},
    {Hazard::ControllerSilent,
     [](Rig& r) {
       r.on_observation = [old = r.request](SupervisorInputs& s) { s.request = old; }, r.tick();
     }},
    {Hazard::MessageOrder, [](Rig& r) { r.on_measurement = [](Measurement& m) { m.seq *= 2; }; }},
    {Hazard::WrongTissueModel,
     [](Rig& r) { r.on_observation = [](SupervisorInputs& s) { s.tissue_residual_um = 501; }; }},
    {Hazard::LogBacklog,
     [](Rig& r) { r.on_observation = [](SupervisorInputs& s) { s.log_backlog_ms = 1'001; }; }},
    {Hazard::PlanUnconfirmed,
     [](Rig& r) { r.on_observation = [](SupervisorInputs& s) { s.confirmed_tag[1] = 0; }; }},
    {Hazard::PanelUntested, [](Rig& r) { r.memory.panel.test = PanelMonitor::Test::None; }},
    {Hazard::StepDepth, [](Rig& r) { move_depth(r, 700, 700); }},
    {Hazard::SuspectTissueModel,
     [](Rig& r) { r.on_observation = [](SupervisorInputs& s) { s.tissue_residual_um = 501; }; }},
    {Hazard::PatientMotion,
     [](Rig& r) { r.on_observation = [](SupervisorInputs& s) { s.patient_motion_um = 2'001; }; }},
};

const HazardFacts& facts_of(Hazard hazard) {
  return kHazardTable[static_cast<std::size_t>(hazard)];
}

Mode mode_after(const HazardFacts& facts) {
  if (facts.locks) return Mode::Lock;
  switch (facts.stop) {
    case StopCategory::C0Off:
      return Mode::Trip;
    case StopCategory::C1Ramp:
      return Mode::Retract;
    case StopCategory::C2Hold:
      return Mode::Hold;
    case StopCategory::None:
      return Mode::Active;
  }
  return Mode::Active;
}

class EveryHazard : public testing::TestWithParam<Fault> {};

TEST_P(EveryHazard, IsNamedInTimeAndStopsTheNeedleAsItsRequirementSays) {
  verifies(facts_of(GetParam().hazard).requirement);
  const Fault& fault = GetParam();
  const HazardFacts& facts = facts_of(fault.hazard);
  Rig rig;
  ASSERT_TRUE(rig.go_to(fault.in));
  ASSERT_EQ(rig.evidence.hazards(), 0U) << name_of(worst_of(rig.evidence.hazards()));
  fault.inject(rig);
  const auto is_named = [&] { return (rig.evidence.hazards() & bit(fault.hazard)) != 0; };
  // Retained charge and a needle that stays are timed from the switching off; allow for the fall from full
  // depth.
  const int fall = fault.in == Mode::Trip ? 20 : 0;
  EXPECT_LE(rig.ticks_until(is_named, 3'000), facts.detect_ms + fall) << facts.name;
  rig.tick();
  EXPECT_LE(permissiveness(rig.state.mode), permissiveness(mode_after(facts))) << name_of(rig.state.mode);
  EXPECT_EQ(rig.output.permit.slew_up_mV_per_tick, 0);
}

TEST_P(EveryHazard, AloneLeadsFromActiveExactlyToItsStop) {
  verifies(facts_of(GetParam().hazard).requirement);
  const HazardFacts& facts = facts_of(GetParam().hazard);
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.on_input = [&](Situation& input) { input.evidence.clear = kAllHazards & ~bit(facts.hazard); };
  rig.tick();
  EXPECT_EQ(rig.output.permit.stop, facts.stop) << facts.name;
  EXPECT_EQ(rig.state.reason, facts.hazard);
  if (facts.locks) rig.tick();
  EXPECT_EQ(rig.state.mode, mode_after(facts));
}

TEST_P(EveryHazard, RefusesReadyAndArming) {
  verifies(facts_of(GetParam().hazard).requirement);
  const HazardFacts& facts = facts_of(GetParam().hazard);
  Rig rig;
  ASSERT_TRUE(rig.go_ready());
  rig.on_input = [&](Situation& input) { input.evidence.clear = kAllHazards & ~bit(facts.hazard); };
  rig.arm = true;
  rig.tick();
  EXPECT_NE(rig.state.mode, Mode::Armed);
  EXPECT_EQ(rig.output.refusal, Refusal::Unhealthy);
  rig.run(100);
  EXPECT_EQ(rig.state.mode, facts.locks ? Mode::Lock : Mode::Safe) << facts.name;
}

std::string requirement_of(const testing::TestParamInfo<Fault>& fault) {
  return "R" + std::string(facts_of(fault.param.hazard).requirement.substr(2));
}

INSTANTIATE_TEST_SUITE_P(Faults, EveryHazard, testing::ValuesIn(kFaults), requirement_of);

TEST(HazardTable, LocksOnWhatOnlyAServiceCanMend) {
  verifies("R-01");
  EXPECT_EQ(locking_hazards(), bit(Hazard::ResidualCharge));
}

TEST(HazardTable, HasAFaultForEveryHazardButTheOneTestedOnPlans) {
  HazardSet tested = bit(Hazard::PlanImplausible);
  for (const Fault& fault : kFaults) tested |= bit(fault.hazard);
  EXPECT_EQ(tested, kAllHazards);
}

TEST(HazardTable, NamesTheWorstOfASet) {
  EXPECT_EQ(worst_of(0), Hazard::None);
  EXPECT_EQ(worst_of(bit(Hazard::PatientMotion) | bit(Hazard::SensorStale)), Hazard::SensorStale);
  EXPECT_EQ(hazards_with(StopCategory::None), 0U);
  EXPECT_EQ(hazards_with(StopCategory::C0Off) | hazards_with(StopCategory::C1Ramp) |
                hazards_with(StopCategory::C2Hold),
            kAllHazards);
}

TEST(Evidence, ProvesNothingFromNothing) {
  verifies("R-47");
  EvidenceMemory memory;
  const Evidence evidence = assess(PlanFacts{}, memory, SupervisorInputs{});
  EXPECT_FALSE(evidence.zero_volts);
  EXPECT_FALSE(evidence.needle_home);
  EXPECT_TRUE(evidence.image_disturbed);
  for (const Hazard hazard :
       {Hazard::EStop, Hazard::ClockJump, Hazard::WrongAnswer, Hazard::SecondWriter, Hazard::PlanChanged,
        Hazard::ConfigChanged, Hazard::SensorStale, Hazard::LaserDropout, Hazard::ControllerSilent,
        Hazard::LogBacklog, Hazard::PlanImplausible, Hazard::PlanUnconfirmed, Hazard::PatientMotion})
    EXPECT_NE(evidence.hazards() & bit(hazard), 0U) << name_of(hazard);
}

}  // namespace
}  // namespace biopsy::safety
