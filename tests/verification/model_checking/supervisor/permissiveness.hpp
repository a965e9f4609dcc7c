// How much a step allowed, in one number, and when one outcome allows no more than another.
#pragma once

#include <algorithm>
#include <cstdint>

#include "tests/verification/model_checking/subject.hpp"

namespace biopsy::model_checking {

// mode 4 | enabled 1 | envelope 24 | slew 20 | depth 14
inline std::uint64_t outcome_of(const SupervisorState& after, const SupervisorOutput& output) {
  const Permit& permit = output.permit;
  const auto upto = [](std::int32_t value, std::int32_t most) {
    return static_cast<std::uint64_t>(std::clamp(value, 0, most));
  };
  return static_cast<std::uint64_t>(after.mode) << 59U | std::uint64_t{permit.hv_enable} << 58U |
         upto(permit.v_max_mV, 0xFF'FFFF) << 34U | upto(permit.slew_up_mV_per_tick, 0xF'FFFF) << 14U |
         upto(permit.depth_max_um, 0x3FFF);
}

// `envelope_mV`: allowed in the tick before; falling from there is never "more".
inline bool is_no_more_permissive(std::uint64_t worse, std::uint64_t better, std::int32_t envelope_mV) {
  const auto field = [](std::uint64_t outcome, unsigned at, std::uint64_t mask) {
    return (outcome >> at) & mask;
  };
  const auto mode = [&](std::uint64_t outcome) { return static_cast<Mode>(field(outcome, 59, 0xF)); };
  const auto volts = [&](std::uint64_t outcome) { return field(outcome, 34, 0xFF'FFFF); };
  const auto slew = [&](std::uint64_t outcome) { return field(outcome, 14, 0xF'FFFF); };
  const auto depth = [&](std::uint64_t outcome) { return field(outcome, 0, 0x3FFF); };
  const auto enabled = [&](std::uint64_t outcome) { return field(outcome, 58, 1); };
  return safety::permissiveness(mode(worse)) <= safety::permissiveness(mode(better)) &&
         volts(worse) <= std::max(volts(better), static_cast<std::uint64_t>(envelope_mV)) &&
         slew(worse) <= slew(better) && depth(worse) <= depth(better) &&
         (mode(worse) == Mode::Retract || enabled(worse) <= enabled(better));  // a ramp keeps its amplifier
}

}  // namespace biopsy::model_checking
