// The depth that people read: the mean of the last 100 ticks in which it was measured, since the laser's
// noise of one tick (0.03 mm) changes the second decimal all the time. Plots show each tick, and the
// supervisor judges each.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "robot/msg/fixed_messages.hpp"
#include "safety/monitors/agreement_monitor.hpp"
#include "safety/monitors/debounce.hpp"

namespace biopsy::robot {

class ShownDepth {
 public:
  void add(const Measurement& m) {
    safety::update(safety::PlanFacts{}, agreement_, m, true);
    blind_score_ =
        safety::accumulated(blind_score_, !m.laser_valid, safety::kComes_goes, safety::kDropout_ticks);
    if (!m.laser_valid) return;
    sum_um_ += m.depth_um - last_um_[at_];
    last_um_[at_] = m.depth_um;
    at_ = (at_ + 1) % last_um_.size();
    if (count_ < last_um_.size()) ++count_;
  }
  // 0 before the first.
  std::int32_t mean_um() const {
    return count_ == 0 ? 0 : static_cast<std::int32_t>(sum_um_ / static_cast<std::int64_t>(count_));
  }
  // Both lasers have their targets and agree, as the supervisor's monitors judge it.
  bool is_known() const { return count_ > 0 && blind_score_ < safety::kDropoutTrip && agreement_.found == 0; }

 private:
  std::array<std::int64_t, 100> last_um_{};
  std::int64_t sum_um_ = 0;
  std::size_t at_ = 0, count_ = 0;
  safety::AgreementMonitor agreement_{.dropout_score = 0};  // of two lasers, as with a patient
  std::int32_t blind_score_ = 0;                            // of the first
};

}  // namespace biopsy::robot
