// How much a step allowed, in one number, and when one outcome allows no more than another. Few outcomes come
// up in a state, so that they are numbered and each pair is judged once.
#pragma once

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <vector>

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

// Numbers in the order of asking: they only tell outcomes apart.
class Outcomes {
 public:
  using Number = std::uint16_t;

  Number number_of(std::uint64_t outcome) {
    const std::lock_guard lock(mutex_);
    const auto at = std::ranges::find(outcomes_, outcome);
    const auto number = static_cast<Number>(at - outcomes_.begin());
    if (at == outcomes_.end()) outcomes_.push_back(outcome);
    return number;
  }

  std::size_t size() const { return outcomes_.size(); }
  // Of each outcome as the worse one, of each as the better one: whether it allows no more.
  std::vector<bool> no_more_permissive(std::int32_t envelope_mV) const {
    std::vector<bool> table;
    for (const std::uint64_t worse : outcomes_)
      for (const std::uint64_t better : outcomes_)
        table.push_back(is_no_more_permissive(worse, better, envelope_mV));
    return table;
  }

 private:
  std::mutex mutex_;
  std::vector<std::uint64_t> outcomes_;
};

}  // namespace biopsy::model_checking
