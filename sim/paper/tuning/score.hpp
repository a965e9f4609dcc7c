// One controller on one stage, in time.
#pragma once

#include "sim/paper/closed_loop.hpp"
#include "sim/paper/tuning/tune.hpp"

namespace biopsy::sim::tuning {

// A way of driving. With feed-forward the target is also given to the loop in steps that the oil can follow.
struct Driving {
  control::PiGains gains{};
  const PlantModel* thought = nullptr;  // feed-forward is taken from it; null: none
  double speed = 0.0;                   // mm/s that a target moves at most; 0: as it is
};

// 0, 2, 8 and 2 mm, against the target as it was asked for.
paper::Course steps(const PlantModel& stage, const Driving& driving);

Score score(const PlantModel& stage, const Driving& driving);

}  // namespace biopsy::sim::tuning
