// The depth that people read: the mean of the last 100 ticks, since the laser's noise of one tick (0.03 mm)
// changes the second decimal all the time. Plots show each tick, and the supervisor judges each.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace biopsy::robot {

class ShownDepth {
 public:
  void add(std::int32_t depth_um) {
    sum_um_ += depth_um - last_um_[at_];
    last_um_[at_] = depth_um;
    at_ = (at_ + 1) % last_um_.size();
    if (count_ < last_um_.size()) ++count_;
  }
  // 0 before the first.
  std::int32_t mean_um() const {
    return count_ == 0 ? 0 : static_cast<std::int32_t>(sum_um_ / static_cast<std::int64_t>(count_));
  }

 private:
  std::array<std::int64_t, 100> last_um_{};
  std::int64_t sum_um_ = 0;
  std::size_t at_ = 0, count_ = 0;
};

}  // namespace biopsy::robot
