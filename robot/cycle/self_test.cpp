#include "robot/cycle/self_test.hpp"

#include "safety/types/limits.hpp"

namespace biopsy::robot {
namespace {

using namespace safety;

constexpr bool names(const Evidence& evidence, Hazard hazard) {
  return (evidence.hazards() & bit(hazard)) != 0;
}

bool fears_what_it_does_not_know(const Examined& examined) {
  EvidenceMemory memory;
  const Evidence nothing = examined.assess(PlanFacts{}, memory, SupervisorInputs{});
  for (const Hazard hazard : {Hazard::EStop, Hazard::SecondWriter, Hazard::PlanChanged, Hazard::ConfigChanged,
                              Hazard::PlanUnconfirmed, Hazard::LogBacklog, Hazard::WrongAnswer})
    if (!names(nothing, hazard)) return false;
  return !nothing.zero_volts && !nothing.needle_home;
}

bool sees_over_voltage(const Examined& examined) {
  EvidenceMemory memory;
  SupervisorInputs seen;
  const auto is_named_at = [&](std::int32_t monitor_mV) {
    seen.measurement.monitor_mV = monitor_mV;
    bool named = false;
    for (int tick = 1; tick <= 5; ++tick) {
      seen.now_us += 1'000, seen.measurement.time_us += 1'000, ++seen.measurement.seq;
      named = names(examined.assess(PlanFacts{}, memory, seen), Hazard::OverVoltage);
    }
    return named;
  };
  return is_named_at(-9'000'000) && !is_named_at(0);
}

Mode mode_after(const Examined& examined, Mode mode, const Evidence& evidence, bool& enabled) {
  SupervisorState state = started(1);
  state.mode = mode;
  SupervisorInputs input;
  input.self_test = SelfTest::Passed;
  const auto [next, output] = examined.step(PlanFacts{}, state, input, evidence);
  enabled = output.permit.hv_enable;
  return next.mode;
}

bool stops_for_a_hazard(const Examined& examined) {
  for (const Mode mode : {Mode::Armed, Mode::Active, Mode::Hold, Mode::Retract}) {
    bool enabled = true;
    if (mode_after(examined, mode, Evidence{}, enabled) != Mode::Trip || enabled) return false;
  }
  return true;
}

bool starts_in_health(const Examined& examined) {
  Evidence healthy;
  healthy.clear = kAllHazards;
  healthy.zero_volts = true;
  bool enabled = true;
  return mode_after(examined, Mode::Boot, healthy, enabled) == Mode::Safe && !enabled;
}

// By hand, from the definition of the function.
bool knows_the_answer(const Examined& examined) {
  return examined.answer_to(0x1234'5678U, -6'000'000, Mode::Active, 42U) == 0xB678'9773U;
}

bool notices_a_changed_plan(const Examined& examined) {
  Plan plan;
  planner::seal(plan);
  const bool held = examined.seal_holds(plan);
  plan.target_depth = Millimetres(plan.target_depth.value + 1.0);
  return held && !examined.seal_holds(plan);
}

}  // namespace

SelfTest self_test(const Examined& examined) {
  for (const auto knows : {fears_what_it_does_not_know, sees_over_voltage, stops_for_a_hazard,
                           starts_in_health, knows_the_answer, notices_a_changed_plan})
    if (!knows(examined)) return SelfTest::Failed;
  return SelfTest::Passed;
}

}  // namespace biopsy::robot
