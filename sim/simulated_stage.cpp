#include "sim/simulated_stage.hpp"

#include <cmath>
#include <numbers>

#include "sim/plant/seeded_noise.hpp"

namespace biopsy::sim {
namespace {

// Must not repeat the first laser's noise.
constexpr std::uint64_t kMonitorStream = 0x6d6f6e69, kSecondLaserStream = 0x6c617332;

// Two independent uniform numbers of unit variance: noise of the monitors needs no tails, at a tenth of the
// cost.
NormalPair uniform_pair(std::uint64_t seed, std::uint64_t counter) {
  constexpr double kScale = 2.0 * std::numbers::sqrt3 * 0x1.0p-32;
  const std::uint64_t bits = hashed(seed, counter);
  return {(static_cast<double>(bits >> 32) - 0x1.0p31) * kScale,
          (static_cast<double>(bits & 0xffffffffU) - 0x1.0p31) * kScale};
}

// The second laser looks at the needle's hub: it has noise of the same size, and nothing else of what the
// model says of the first.
double second_reading(const PlantModel& model, std::uint64_t seed, const PlantState& state) {
  const double std = model.effects.sensor_noise ? model.effects.sensor_noise->std : 0.0;
  return state.motion.x + std * normals(seed ^ kSecondLaserStream, state.readings).first;
}

std::int32_t rounded(double value) {
  return static_cast<std::int32_t>(std::lround(value));
}

}  // namespace

SimulatedStage::SimulatedStage(const PlantModel& model, std::uint64_t seed, const DeviceErrors& errors)
    : model_(model), stepper_(model), errors_(errors), seed_(seed), state_(at_rest(model)) {
  model_.noise_seed = seed;
}

drivers::SensorReading SimulatedStage::read() {
  drivers::SensorReading reading;
  reading.time_us = now_us_;
  reading.laser_code = rounded(displacement_reading(model_, state_) * 1e6 / errors_.laser_code_um);
  reading.depth_um = reading.laser_code * errors_.laser_code_um;
  reading.laser_valid = true;
  reading.depth_b_um = rounded(second_reading(model_, seed_, state_) * 1e6);
  reading.laser_b_valid = true;
  const NormalPair noise = uniform_pair(seed_ ^ kMonitorStream, state_.readings);
  reading.monitor_mV = rounded(state_.u_i * 1e3 * (1.0 + errors_.monitor_noise * noise.first));
  const double average = state_.charge / Seconds(kTick).count();
  reading.brake_fitted = model_.brake.has_value();
  reading.current_nA = rounded((average + errors_.current_noise_A * noise.second) * 1e9);
  return reading;
}

void SimulatedStage::move_brake(bool on, double holding) {
  if (!model_.brake) return;
  const Brake& brake = *model_.brake;
  const bool grips = grip_.stiffness > 0.0;
  brake_s_ = on == grips ? 0.0 : brake_s_ + Seconds(kTick).count();
  if (on && !grips && brake_s_ > brake.engage_s)
    grip_ = {brake.stiffness, brake.damping, holding * brake.holding_N, state_.motion.x};
  if (!on && brake_s_ > brake.release_s) grip_ = {};
  grip_.follow(state_.motion.x);
}

void SimulatedStage::put_out(double volts, bool brake_on, double holding) {
  move_brake(brake_on, holding);
  stepper_.advance(model_, state_, {.voltage = volts, .external_force = push_N_, .grip = grip_},
                   Seconds(kTick));
  now_us_ += std::chrono::microseconds(kTick).count();
}

}  // namespace biopsy::sim
