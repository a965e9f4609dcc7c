// From plate A to the number that is read.
#pragma once

#include "sim/plant/plant.hpp"

namespace biopsy::sim {

// Position of the sensor's target: plate A's or what transmits it, plus the target's own motion. m
inline double target_position(const PlantModel& model, const PlantState& state) {
  double position = state.motion.x;
  for_each_present(model.effects, state.motion.integrated, state.remembered,
                   [&]<class E>(const E& effect, const auto&... own) {
                     if constexpr (requires { &E::transmitted; }) position = effect.transmitted(own...);
                   });
  for_each_present(model.effects, [&]<class E>(const E& effect) {
    if constexpr (requires { &E::target_motion; }) position += effect.target_motion(state.time);
  });
  return position;
}

// The sensor's filters after h, the target having gone straight from `from` to where it is now.
inline void follow_target(const PlantModel& model, PlantState& state, double from, double h) {
  if (h <= 0.0) return;  // plate A broke away in the very instant in which it stopped
  const double to = target_position(model, state);
  for_each_present(model.effects, state.motion.integrated, state.remembered,
                   [&]<class E>(const E& effect, auto&... own) {
                     if constexpr (requires { &E::follow; }) effect.follow(from, to, h, own...);
                   });
}

}  // namespace biopsy::sim
