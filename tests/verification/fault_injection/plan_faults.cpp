// What is wrong with the plan, its numbers, its confirmations, the configuration, or the units of a request.
#include <string>

#include "planner/plan/seal.hpp"
#include "tests/verification/fault_injection/fault_class.hpp"

namespace biopsy::fault_injection {
namespace {

using safety::bit;
using safety::Hazard;

// What is in use is not what was sealed: changed in memory, gone, or another one.
Corruptors change_plan(Draw& draw, Procedure&, const TickRecord&) {
  const std::uint64_t flaw = std::uint64_t{1} << draw.whole(0, 63);
  const bool gone = draw.coin();
  return {.observation = [=](safety::SupervisorInputs& seen) {
    seen.plan_tag = gone ? 0 : seen.plan_tag ^ flaw;
  }};
}

// The same plan for another patient, image, pose or target, sealed anew.
Corruptors take_another(Draw& draw, Procedure& procedure, const TickRecord&) {
  Plan other = procedure.scenario().plan;
  switch (draw.whole(0, 4)) {
    case 0:
      other.target.patient_id += "1";
      break;
    case 1:
      other.target.series_uid += ".1";
      break;
    case 2:
      other.X_SR.translation().x() += draw.within(0.001, 5.0);
      break;
    case 3:
      other.target.p_ST.z() += draw.within(0.001, 1.0);
      break;
    default:
      other.steps.back().depth.value += draw.within(0.001, 1.0);
  }
  planner::seal(other);
  const std::uint64_t tag = planner::plan_tag(other);
  return {.observation = [=](safety::SupervisorInputs& seen) { seen.plan_tag = tag; }};
}

Corruptors tamper(Draw& draw, Procedure&, const TickRecord&) {
  const std::uint64_t flaw = std::uint64_t{1} << draw.whole(0, 63);
  const bool gone = draw.coin();
  return {.observation = [=](safety::SupervisorInputs& seen) {
    seen.config_tag = gone ? 0 : seen.config_tag ^ flaw;
  }};
}

Corruptors unconfirm(Draw& draw, Procedure&, const TickRecord&) {
  const auto who = static_cast<std::size_t>(draw.whole(0, 1));
  const std::uint64_t shown = draw.coin() ? 0 : draw.bits();
  return {.observation = [=](safety::SupervisorInputs& seen) { seen.confirmed_tag[who] = shown; }};
}

// One kind of number in a wrong unit: millimetres or nanometres, volts or kilovolts.
Corruptors slip_units(Draw& draw, Procedure& procedure, const TickRecord&) {
  safety::PlanFacts& facts = procedure.facts();
  const bool less = draw.coin();
  const auto slip = [less](std::int32_t& value) {
    value = less ? value / 1'000 : static_cast<std::int32_t>(std::int64_t{value} * 200 % 2'000'000'000);
  };
  const auto each_stage = [&](auto member) {
    for (std::uint32_t i = 0; i < facts.step_count; ++i) slip(facts.steps[i].*member);
  };
  switch (draw.whole(0, 4)) {
    case 0:
      slip(facts.depth_max_um);
      break;
    case 1:
      each_stage(&safety::StepLimits::depth_max_um);
      break;
    case 2:
      each_stage(&safety::StepLimits::v_max_mV);
      break;
    case 3:
      each_stage(&safety::StepLimits::slew_up_mV_per_tick);
      break;
    default:
      for (std::uint32_t i = 0; i < facts.band_count; ++i) slip(facts.bands[i].drive_mV);
  }
  return {};
}

// A controller that runs away, or asks in microvolts: the gate gives what the stage's envelope allows.
Corruptors ask_too_much(Draw& draw, Procedure&, const TickRecord&) {
  const std::int32_t asked_mV = draw.whole(8'000'000, 2'000'000'000);
  return {.request =
              [=](DriveRequest& r) {
                r.wanted_mV = r.wanted_mV < 0 ? -asked_mV : asked_mV;
                r.step_reached = false;
              },
          .shows =
              [](const ObservedTick& s) {
                return s.seen.permit.mode == Mode::Active &&
                       s.seen.measurement.depth_um > s.seen.permit.depth_max_um;
              }};
}

}  // namespace

std::vector<FaultClass> plan_faults() {
  FaultClass other = class_of(Hazard::PlanChanged, kReadyOrDriven, take_another);
  other.id += "/other";
  other.what = "another patient, image, pose or target";

  // a plan is taken up at rest only; in motion its tag stands for it
  FaultClass units = class_of(Hazard::PlanImplausible, {Mode::Ready}, slip_units);

  FaultClass runaway = class_of(Hazard::StepDepth, {Mode::Active}, ask_too_much);
  runaway.id += "/runaway";
  runaway.what = "controller asks for far too much";
  runaway.row = 2;
  // Where the controller wants nothing its sign is lost, and with it the wave.
  runaway.instead = bit(Hazard::HardOverDepth) | bit(Hazard::OverDepth) | bit(Hazard::PopThrough) |
                    bit(Hazard::WrongFrequency) | bit(Hazard::PolarityStuck);
  return {class_of(Hazard::PlanChanged, kReadyOrDriven, change_plan),
          other,
          class_of(Hazard::ConfigChanged, kReadyOrDriven, tamper),
          class_of(Hazard::PlanUnconfirmed, kReadyOrDriven, unconfirm),
          units,
          runaway};
}

}  // namespace biopsy::fault_injection
