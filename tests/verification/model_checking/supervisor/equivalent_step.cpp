#include "tests/verification/model_checking/supervisor/equivalent_step.hpp"

#include <algorithm>
#include <bit>

#include "tests/safety/situation.hpp"

namespace biopsy::model_checking {
namespace {

using safety::bit;
using safety::Hazard;
using safety::HazardSet;

// SplitMix64: the differences are varied, and the same in every run.
class Choice {
 public:
  explicit Choice(std::uint64_t number) : state_(number) {}
  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9E37'79B9'7F4A'7C15ULL;
    z = (z ^ (z >> 30)) * 0xBF58'476D'1CE4'E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D0'49BB'1331'11EBULL;
    return z ^ (z >> 31);
  }

 private:
  std::uint64_t state_;
};

// A number below `end`, by 32 bits of a choice.
std::uint32_t below(std::uint32_t end, std::uint64_t choice) {
  return static_cast<std::uint32_t>((choice & 0xFFFF'FFFFU) * end >> 32U);
}

// One member of a set: the first from a place that `choice` names.
HazardSet one_of(HazardSet members, std::uint64_t choice) {
  const HazardSet from_there = members & (~HazardSet{0} << choice % 64);
  const HazardSet left = from_there != 0 ? from_there : members;
  return left & -left;
}

// The hazards with each class filled by others of its members: by one alone or by some.
HazardSet other_members(HazardSet hazards, std::uint64_t choice) {
  static const auto kClasses = [] {
    std::array<HazardSet, kClassHazard.size()> classes{};
    std::ranges::transform(kClassHazard, classes.begin(), class_of);
    return classes;
  }();
  HazardSet others = 0;
  for (const HazardSet members : kClasses) {
    const HazardSet some = members & choice;
    const std::array<HazardSet, 2> ways{some,
                                        one_of(members, choice >> 40U)};  // no branch: choices are random
    const bool alone = (choice >> 63U) != 0 || some == 0;
    others |= ways[alone] & -HazardSet{(hazards & members) != 0};
  }
  return others;
}

void vary_memory(SupervisorState& state, std::uint64_t choice) {
  const Timer timer = timer_of(state.mode);
  state.session += static_cast<std::uint32_t>(1U + (choice & 0xFFU));
  state.epoch += static_cast<std::uint32_t>((choice >> 8U) & 0xFFU);
  state.seq += static_cast<std::uint32_t>((choice >> 16U) & 0xFFFFU);
  state.last_event = static_cast<safety::Event>(below(safety::kEvents, choice >> 32));
  state.reason = static_cast<Hazard>(below(safety::kHazards, choice >> 30));
  if (timer != Timer::InMode) state.ms_in_mode = static_cast<std::int32_t>(below(30'002, choice >> 24));
  if (timer != Timer::SinceHeld) state.ms_since_held = static_cast<std::int32_t>(below(101, choice >> 20));
  if (!remembers_arm_key(state.mode)) state.arm_was_down = ((choice >> 44U) & 1U) != 0;
  if (!remembers_reset_key(state.mode)) state.reset_was_down = ((choice >> 45U) & 1U) != 0;
  if (!remembers_voltage(state.mode))
    state.held_mV = static_cast<std::int32_t>(below(8'000'001, choice >> 12));
}

// An image stays as much younger or older than the arrival, and neither is of the future.
void vary_arrival(SupervisorState& state, Situation& input, std::uint64_t choice) {
  const auto shift = below(1 + state.seq - state.arrived_seq, choice);
  state.arrived_seq += shift;
  input.accepted_since_seq += shift;
}

void vary_motion(SupervisorState& state, Situation& input, std::uint64_t choice) {
  const auto shift = below(1'000'000, choice);
  if (state.token == 0) {
    if (input.motion.token != 0) input.motion.token += shift;
    return;
  }
  const bool older = input.motion.token < state.token;
  if (input.motion.token != 0) input.motion.token += older ? shift / 2U : shift;
  state.token += shift;
}

// How far another step's number is off, modulo 2^32: the one before, the one after, or any.
std::uint32_t other_by(std::uint64_t choice) {
  if (choice % 4 == 0) return 0xFFFF'FFFFU;
  return choice % 4 == 1 ? 1U : 1U + below(0xFFFF'FFFFU, choice >> 2U);
}

// The fields of an input that inputs.hpp chooses. One that was forgotten here would break the claim.
void copy_values(const Situation& from, Situation& to) {
  const auto field = [&](auto member) { to.*member = from.*member; };
  field(&Situation::self_test);
  field(&Situation::stop);
  field(&Situation::local_arm), field(&Situation::local_reset);
  field(&Situation::motion);
  field(&Situation::depth_accepted);
  field(&Situation::accepted_step), field(&Situation::accepted_session);
  field(&Situation::accepted_since_seq);
  field(&Situation::acquiring);
  to.request.step_reached = from.request.step_reached;
  to.request.finished = from.request.finished;
  to.request.step = from.request.step;
  to.measurement.brake_fitted = from.measurement.brake_fitted;
  const auto seen = [&](auto member) { to.evidence.*member = from.evidence.*member; };
  seen(&safety::Evidence::zero_volts);
  seen(&safety::Evidence::needle_home), seen(&safety::Evidence::needle_back);
  seen(&safety::Evidence::locked), seen(&safety::Evidence::still);
  seen(&safety::Evidence::interlock_opens);
  seen(&safety::Evidence::drive_mV), seen(&safety::Evidence::ceiling_mV);
}

// As the invariants of the names say; voltage that nobody measures is the fault of the missing measurement.
bool names_its_hazard(const EquivalentStep& equivalent, const Stepped& step) {
  const auto& [next, output] = step;
  const HazardSet hazards = equivalent.input.evidence.hazards();
  const bool renamed = equivalent.state.mode != next.mode && output.event != safety::Event::VoltageGone;
  const bool unseen =
      output.event == safety::Event::VoltagePresent && (hazards & bit(Hazard::SensorStale)) != 0;
  const Hazard named = unseen ? Hazard::SensorStale : safety::worst_of(hazards);
  return output.worst == safety::worst_of(hazards) && output.reason == next.reason &&
         next.reason == (renamed ? named : equivalent.state.reason);
}

// Whatever decides nothing in this mode.
void vary_input(const SupervisorState& state, Situation& input, std::uint64_t choice) {
  const Mode mode = state.mode;
  const bool moving = mode == Mode::Active || mode == Mode::Hold;
  const auto chosen = [choice](unsigned bit) { return ((choice >> bit) & 1U) != 0; };
  input.now_us = static_cast<std::int64_t>(choice >> 24);
  input.remote_arm = !chosen(0) || chosen(1);
  input.remote_reset = chosen(0);
  input.evidence.image_disturbed = chosen(2);
  input.request.seq = input.request.overruns = static_cast<std::uint32_t>(choice >> 3);
  input.request.wanted_mV = input.request.setpoint_um = static_cast<std::int32_t>(choice >> 5);
  const std::uint32_t other = other_by(choice >> 8U);
  if (mode != Mode::Boot) input.self_test = static_cast<safety::SelfTest>(below(3, choice >> 10));
  if (mode != Mode::Boot) input.evidence.interlock_opens = chosen(21);
  if (mode != Mode::Trip) input.evidence.needle_home = chosen(12);
  input.evidence.estop_reset = chosen(22);
  if (moving) {
    input.evidence.zero_volts = chosen(24);
  } else {
    input.request.step_reached = chosen(13);
    input.request.finished = chosen(14);
    input.evidence.drive_mV = static_cast<std::int32_t>(below(8'000'001, choice >> 16));
  }
  if (!moving && mode != Mode::Armed)
    input.evidence.ceiling_mV = static_cast<std::int32_t>(below(8'000'001, choice >> 20));
  if (mode != Mode::Hold) input.depth_accepted = chosen(15), input.evidence.still = chosen(16);
  if (mode != Mode::Safe && mode != Mode::Ready) input.evidence.needle_back = chosen(19);
  if (!can_lead_to_ready(mode)) input.local_arm = chosen(23);
  if (!moving) input.measurement.brake_fitted = chosen(20);
  if (!moving && mode != Mode::Armed) input.evidence.locked = chosen(17);
  if (mode != Mode::Hold && mode != Mode::Armed) input.acquiring = chosen(18);
  if (input.request.step != state.step) input.request.step = state.step + other;
  if (mode != Mode::Hold || input.accepted_step != state.step) input.accepted_step = state.step + other;
}

}  // namespace

EquivalentStep equivalent_step(const SupervisorState& state, const Situation& input, std::uint64_t number) {
  EquivalentStep equivalent{state, input};
  write_equivalent_step(state, input, number, equivalent);
  return equivalent;
}

void write_equivalent_step(const SupervisorState& state, const Situation& input, std::uint64_t number,
                           EquivalentStep& equivalent) {
  Choice choice(number);
  equivalent.state = state;
  copy_values(input, equivalent.input);
  equivalent.input.evidence.clear =
      safety::kAllHazards & ~other_members(input.evidence.hazards(), choice.next());
  vary_memory(equivalent.state, choice.next());
  equivalent.input.accepted_session += equivalent.state.session - state.session;
  vary_arrival(equivalent.state, equivalent.input, choice.next());
  vary_motion(equivalent.state, equivalent.input, choice.next());
  vary_input(equivalent.state, equivalent.input, choice.next());
}

EquivalentPlans::EquivalentPlans(const PlanFacts& plan) {
  plans_.fill(plan);
  for (std::uint32_t unlike = 0; unlike < plans_.size(); ++unlike)
    for (std::uint32_t step = 0; step < kVaried; ++step)
      if (((unlike >> step) & 1U) != 0) plans_[unlike].steps[step].image_confirms ^= true;
}

const PlanFacts& EquivalentPlans::of(const SupervisorState& state, std::uint64_t number) const {
  const std::uint64_t unlike = Choice(~number).next() % plans_.size();
  return plans_[unlike & ~(std::uint64_t{state.step < kVaried} << (state.step % kVaried))];
}

bool has_equal_outcome(std::uint64_t key, const Stepped& step, const EquivalentStep& other,
                       const Stepped& other_step) {
  const auto& [next, output] = step;
  const auto& [other_next, other_output] = other_step;
  const Permit &permit = output.permit, &equivalent = other_output.permit;
  return key == key_of(other_next) && output.event == other_output.event &&
         next.epoch - kEpoch == other_next.epoch - other.state.epoch && permit.mode == equivalent.mode &&
         permit.stop == equivalent.stop && permit.hv_enable == equivalent.hv_enable &&
         permit.v_max_mV == equivalent.v_max_mV &&
         permit.slew_up_mV_per_tick == equivalent.slew_up_mV_per_tick &&
         permit.depth_max_um == equivalent.depth_max_um && permit.brake == equivalent.brake &&
         output.interlock_pulse == other_output.interlock_pulse &&
         output.image_allowed == other_output.image_allowed && names_its_hazard(other, other_step);
}

}  // namespace biopsy::model_checking
