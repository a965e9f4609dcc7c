#pragma once

#include <array>

#include "sim/effects/effect.hpp"
#include "sim/plant/seeded_noise.hpp"

namespace biopsy::sim {

// White Gaussian noise on every reading, a function of the seed and the number of the reading
// (seeded_noise.hpp).
struct SensorNoise {
  double std = 0.0;  // m

  double read(double reading, const ReadingMoment& at) const {
    return reading + std * normals(at.seed, at.reading).first;
  }

  static constexpr EffectInfo info{"sensor_noise",
                                   Attachment::Sensor,
                                   "Every reading of the laser has random noise.",
                                   "reading = x + std N(0, 1)",
                                   "dc_hold",
                                   "white noise; BL-100NMZ class sensor: 10 um"};
  static constexpr auto parameters() {
    return std::array{Parameter<SensorNoise>{"std_mm", &SensorNoise::std, 1e-3, 0.0, 1.0, 0.010,
                                             "standard deviation", Role::Strength}};
  }
};

}  // namespace biopsy::sim
