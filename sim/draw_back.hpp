// The person beside a simulated stage: draws a needle that friction holds out back along its guide, some
// seconds after high voltage went off.
#pragma once

#include <algorithm>
#include <cstdint>

#include "sim/simulated_stage.hpp"

namespace biopsy::sim {

class DrawBack {
 public:
  // Once a tick of 1 ms.
  void tick(SimulatedStage& stage, bool hv_enabled) {
    off_ticks_ = hv_enabled ? 0 : std::min(off_ticks_ + 1, kWait_ticks);
    const double x = stage.truth().motion.x;
    if (off_ticks_ < kWait_ticks || x <= kThere_m) return;
    stage.place(std::max(0.0, x - kStride_m));
  }

 private:
  static constexpr std::int32_t kWait_ticks = 3'000;           // reads the screen first
  static constexpr double kThere_m = 20e-6, kStride_m = 2e-6;  // 2 mm/s
  std::int32_t off_ticks_ = 0;
};

}  // namespace biopsy::sim
