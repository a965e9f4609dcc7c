// One controller on one stage, simulated in time.
#pragma once

#include "sim/paper/closed_loop.hpp"
#include "sim/paper/tuning/tune.hpp"

namespace biopsy::sim::tuning {

// A controller. With feed-forward the target is also limited in speed, so that the oil can follow it.
struct Driving {
  PiGains gains{};
  const PlantModel* feed_model = nullptr;  // of the feed-forward; null: none
  double speed = 0.0;                      // mm/s that a target moves at most; 0: as it is
};

// 0, 2, 8 and 2 mm, against the unlimited target.
paper::Course steps(const PlantModel& stage, const Driving& driving);

Score score(const PlantModel& stage, const Driving& driving);

}  // namespace biopsy::sim::tuning
