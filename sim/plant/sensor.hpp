// From plate A to the number that is read.
#pragma once

#include "sim/plant/plant.hpp"

namespace biopsy::sim {

// Where the sensor's target stands now: plate A through the play, plus the disturbance's motion. m
inline double sensed(const PlantModel& model, const PlantState& state) {
  const Effects& e = model.effects;
  double seen = e.backlash ? state.memory.carried : state.motion.x;
  if (e.periodic_disturbance)
    seen += e.periodic_disturbance->motion * e.periodic_disturbance->wave(state.time);
  return seen;
}

// The sensor's filters after h, its target having gone straight from `from` to where it stands now.
inline void remember_reading(const PlantModel& model, PlantState& state, double from, double h) {
  const auto& lag = model.effects.sensor_lag;
  if (!lag || h <= 0.0) return;  // plate A broke away in the very instant in which it stopped
  const double before = state.reading;
  state.reading = lag->lagged(from, sensed(model, state), before, h);
  state.memory.delay = lag->delayed(before, state.reading, state.memory.delay, h);
}

// The filters as a target that moves with v for long already leaves them.
inline void settle_reading(const PlantModel& model, PlantState& state, double v) {
  state.reading = sensed(model, state);
  const auto& lag = model.effects.sensor_lag;
  if (!lag) return;
  state.reading -= v * lag->time;
  state.memory.delay = {state.reading - 0.5 * v * lag->delay, v * lag->delay};
}

}  // namespace biopsy::sim
