#include "robot/cycle/self_test.hpp"

#include "safety/types/limits.hpp"

namespace biopsy::robot {
namespace {

using namespace safety;

constexpr bool names(const Evidence& evidence, Hazard hazard) {
  return (evidence.hazards() & bit(hazard)) != 0;
}

bool treats_unknown_as_hazard(const TestedFunctions& tested) {
  EvidenceMemory memory;
  const Evidence nothing = tested.assess(PlanFacts{}, memory, SupervisorInputs{});
  for (const Hazard hazard :
       {Hazard::EStop, Hazard::SecondWriter, Hazard::PlanChanged, Hazard::ConfigChanged,
        Hazard::PlanUnconfirmed, Hazard::LogBacklog, Hazard::WrongAnswer, Hazard::PanelUntested})
    if (!names(nothing, hazard)) return false;
  return !nothing.zero_volts && !nothing.needle_home;
}

bool finds_over_voltage(const TestedFunctions& tested) {
  EvidenceMemory memory;
  SupervisorInputs seen;
  const auto is_named_at = [&](std::int32_t monitor_mV) {
    seen.measurement.monitor_mV = monitor_mV;
    bool named = false;
    for (int tick = 1; tick <= 5; ++tick) {
      seen.now_us += 1'000, seen.measurement.time_us += 1'000, ++seen.measurement.seq;
      named = names(tested.assess(PlanFacts{}, memory, seen), Hazard::OverVoltage);
    }
    return named;
  };
  return is_named_at(-9'000'000) && !is_named_at(0);
}

Mode mode_after(const TestedFunctions& tested, Mode mode, const Evidence& evidence, bool& enabled) {
  SupervisorState state = started(1);
  state.mode = mode;
  SupervisorInputs input;
  input.self_test = SelfTest::Passed;
  const auto [next, output] = tested.step(PlanFacts{}, state, input, evidence);
  enabled = output.permit.hv_enable;
  return next.mode;
}

bool stops_for_a_hazard(const TestedFunctions& tested) {
  for (const Mode mode : {Mode::Armed, Mode::Active, Mode::Hold, Mode::Retract}) {
    bool enabled = true;
    if (mode_after(tested, mode, Evidence{}, enabled) != Mode::Trip || enabled) return false;
  }
  return true;
}

bool starts_when_healthy(const TestedFunctions& tested) {
  Evidence healthy;
  healthy.clear = kAllHazards;
  healthy.zero_volts = true;
  bool enabled = true;
  if (mode_after(tested, Mode::Boot, healthy, enabled) != Mode::Boot) return false;  // interlock unproven
  healthy.interlock_opens = true;
  return mode_after(tested, Mode::Boot, healthy, enabled) == Mode::Safe && !enabled;
}

// Computed by hand from the definition.
bool answers_the_challenge(const TestedFunctions& tested) {
  return tested.answer_to(0x1234'5678U, -6'000'000, Mode::Active, 42U) == 0xB678'9773U;
}

bool finds_a_changed_plan(const TestedFunctions& tested) {
  Plan plan;
  planner::seal(plan);
  const bool held = tested.seal_holds(plan);
  plan.target_depth = Millimetres(plan.target_depth.value + 1.0);
  return held && !tested.seal_holds(plan);
}

}  // namespace

SelfTest self_test(const TestedFunctions& tested) {
  for (const auto knows : {treats_unknown_as_hazard, finds_over_voltage, stops_for_a_hazard,
                           starts_when_healthy, answers_the_challenge, finds_a_changed_plan})
    if (!knows(tested)) return SelfTest::Failed;
  return SelfTest::Passed;
}

}  // namespace biopsy::robot
