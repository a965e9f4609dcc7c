#include "tests/verification/model_checking/supervisor/inputs.hpp"

#include <algorithm>

#include "tests/safety/situation.hpp"
#include "tests/verification/model_checking/supervisor/states.hpp"

namespace biopsy::model_checking {
namespace {

using safety::bit;
using safety::Hazard;
using safety::HazardSet;

constexpr std::int32_t kAll_mV = 8'000'000;

std::vector<HazardSet> hazard_values(Grain grain) {
  std::vector<HazardSet> values{0};
  if (grain == Grain::Quick) {
    HazardSet all = 0;
    for (const Hazard hazard : kClassHazard) values.push_back(bit(hazard)), all |= bit(hazard);
    values.push_back(bit(kClassHazard[1]) | bit(kClassHazard[2]));
    values.push_back(all);
  }
  for (unsigned combination = 1; grain == Grain::Full && combination < 16; ++combination) {
    HazardSet set = 0;
    for (unsigned i = 0; i < kClassHazard.size(); ++i)
      if (((combination >> i) & 1U) != 0) set |= bit(kClassHazard[i]);
    values.push_back(set);
  }
  return values;
}

std::uint32_t token_of(unsigned relation, const SupervisorState& state) {
  if (relation == 0) return 0;
  if (state.token == 0) return relation == 3 ? 1 : 0;
  return state.token - 2 + relation;  // old, present, new
}

// Sets that differ by one more hazard.
std::vector<Worsening> more_hazards(const std::vector<HazardSet>& values) {
  std::vector<Worsening> worse;
  for (std::size_t a = 0; a < values.size(); ++a)
    for (std::size_t b = 0; b < values.size(); ++b)
      if ((values[a] & ~values[b]) == 0 && std::popcount(values[b]) == std::popcount(values[a]) + 1)
        worse.emplace_back(a, b);
  return worse;
}

std::vector<Worsening> chain_down(std::uint32_t size) {
  std::vector<Worsening> worse;
  for (std::uint32_t i = 1; i < size; ++i) worse.emplace_back(i, i - 1);
  return worse;
}

// Values are 2 x {nothing, old, present, new} + held. Letting go is worse than holding, silence is worse than
// holding, a release or a second press during motion is worse than silence.
std::vector<Worsening> worse_motions(Mode mode) {
  std::vector<Worsening> worse{{1, 0}, {3, 2}, {5, 4}, {7, 6}, {3, 0}, {5, 0}, {0, 4}, {0, 6}};
  worse.push_back(mode == Mode::Active ? Worsening{0, 7} : Worsening{7, 0});
  return worse;
}

}  // namespace

HazardSet class_of(Hazard hazard) {
  HazardSet members = 0;
  const safety::HazardFacts& facts = safety::kHazardTable[static_cast<std::size_t>(hazard)];
  for (const safety::HazardFacts& other : safety::kHazardTable)
    if (other.stop == facts.stop && other.locks == facts.locks) members |= bit(other.hazard);
  return members;
}

std::vector<InputSpace::Drive> InputSpace::drive_values(Grain grain) {
  if (grain == Grain::Thin) return {{0, 0}, {kAll_mV, kAll_mV}};
  if (grain == Grain::Quick) return {{0, 0}, {kAll_mV, 0}, {kAll_mV, kAll_mV}};
  return {{0, 0}, {1, 1}, {kAll_mV, 0}, {kAll_mV, kAll_mV}};
}

InputSpace::InputSpace(Mode mode, Grain grain)
    : hazards_(hazard_values(grain)), drives_(drive_values(grain)) {
  set_sizes(mode);
  set_worse(mode);
  for (std::size_t d = 0; d < kDimensions; ++d) {
    strides_[d] = size_;
    size_ *= sizes_[d];
  }
}

void InputSpace::set_sizes(Mode mode) {
  const bool moving = mode == Mode::Active || mode == Mode::Hold;
  const auto drives = static_cast<std::uint32_t>(drives_.size());
  sizes_ = {static_cast<std::uint32_t>(hazards_.size()),
            4,
            moving ? 1U : 2U,
            can_lead_to_ready(mode) ? 2U : 1U,
            2,
            8,
            mode == Mode::Boot ? 6U : 1U,
            mode == Mode::Trip ? 2U : 1U,
            moving ? 8U : 1U,
            mode == Mode::Hold ? 6U : 1U,
            moving || mode == Mode::Armed ? drives : 1U,
            mode == Mode::Ready || mode == Mode::Trip || mode == Mode::Lock ? 4U : 1U,
            mode == Mode::Hold || mode == Mode::Armed ? 2U : 1U,
            mode == Mode::Hold     ? 4U
            : mode == Mode::Active ? 3U
                                   : 1U,
            mode == Mode::Safe || mode == Mode::Ready ? 2U : 1U};
}

void InputSpace::set_worse(Mode mode) {
  const auto of = [this](Dimension d) -> std::vector<Worsening>& {
    return worse_[static_cast<std::size_t>(d)];
  };
  of(Dimension::Hazards) = more_hazards(hazards_);
  of(Dimension::Stop) = {{0, 1}, {1, 2}, {2, 3}};
  of(Dimension::Motion) = worse_motions(mode);
  for (const Dimension d : {Dimension::ZeroVolts, Dimension::ArmKey, Dimension::ResetKey,
                            Dimension::NeedleHome, Dimension::Image, Dimension::Brake, Dimension::NeedleBack})
    of(d) = chain_down(size_of(d));
  of(Dimension::Drive) = size_of(Dimension::Drive) == 4
                             ? std::vector<Worsening>{{3, 1}, {3, 2}, {1, 0}, {2, 0}}
                             : chain_down(size_of(Dimension::Drive));
  // Values are reached + 2 finished + 4 another step.
  if (size_of(Dimension::Request) > 1)
    of(Dimension::Request) = {{0, 1}, {0, 2}, {1, 3}, {2, 3}, {4, 5}, {4, 6}, {5, 7}, {6, 7}};
  if (size_of(Dimension::Depth) > 1) of(Dimension::Depth) = {{1, 0}, {1, 2}, {1, 3}, {1, 4}, {1, 5}};
  // Values are the result + 3 where the interlock opens on the driver's timer.
  if (size_of(Dimension::SelfTest) > 1)
    of(Dimension::SelfTest) = {{1, 0}, {2, 1}, {4, 3}, {5, 4}, {3, 0}, {4, 1}, {5, 2}};
}

Digits InputSpace::digits(std::uint32_t index) const {
  Digits digit{};
  for (std::size_t d = 0; d < kDimensions; ++d)
    digit[d] = static_cast<std::uint8_t>(index / strides_[d] % sizes_[d]);
  return digit;
}

Situation InputSpace::at(std::uint32_t index, const SupervisorState& state) const {
  Situation input;
  input.self_test = safety::SelfTest::Passed;
  const Digits digit = digits(index);
  for (std::size_t d = 0; d < kDimensions; ++d) put(input, static_cast<Dimension>(d), digit[d], state);
  return input;
}

void InputSpace::put(Situation& input, Dimension d, std::uint8_t value, const SupervisorState& state) const {
  const bool forgotten = size_of(d) == 1;
  switch (d) {
    case Dimension::Hazards:
      input.evidence.clear = safety::kAllHazards & ~hazards_[value];
      break;
    case Dimension::Stop:
      input.stop = static_cast<StopCategory>(value);
      break;
    case Dimension::ZeroVolts:
      input.evidence.zero_volts = forgotten || value == 1;
      break;
    case Dimension::ArmKey:
      input.local_arm = value == 1;
      break;
    case Dimension::ResetKey:
      input.local_reset = value == 1;
      break;
    case Dimension::Motion:
      input.motion = {token_of(value / 2U, state), value % 2U == 1};
      break;
    case Dimension::SelfTest:
      if (!forgotten) input.self_test = static_cast<safety::SelfTest>(value % 3);
      input.evidence.interlock_opens = forgotten || value >= 3;
      break;
    case Dimension::NeedleHome:
      input.evidence.needle_home = forgotten || value == 1;
      break;
    case Dimension::Request:
      input.request.step_reached = (value & 1U) != 0;
      input.request.finished = (value & 2U) != 0;
      input.request.step = state.step + ((value & 4U) != 0 ? 1 : 0);
      break;
    case Dimension::Depth:
      input.depth_accepted = value != 0;
      input.accepted_step = state.step + (value == 2 ? 1U : 0U) - (value == 3 ? 1U : 0U);
      input.accepted_since_seq = state.arrived_seq - (value == 4 ? 1U : 0U);
      input.accepted_session = state.session + (value == 5 ? 1U : 0U);
      break;
    case Dimension::Drive:
      input.evidence.drive_mV = forgotten ? 0 : drives_[value].drive_mV;
      input.evidence.ceiling_mV = forgotten ? 0 : drives_[value].ceiling_mV;
      break;
    case Dimension::Network:
      input.remote_arm = (value & 1U) != 0;
      input.remote_reset = (value & 2U) != 0;
      break;
    case Dimension::Image:
      input.acquiring = !forgotten && value == 0;
      break;
    case Dimension::Brake:
      input.measurement.brake_fitted = value >= 1;
      input.evidence.locked = value >= 2;
      input.evidence.still = value == 3;
      break;
    case Dimension::NeedleBack:
      input.evidence.needle_back = forgotten || value == 1;
      break;
  }
}

}  // namespace biopsy::model_checking
