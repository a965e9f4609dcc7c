// The plant: voltage in, motion out. step() is a function of its arguments and nothing else.
// Electrical part exact; mechanics by third-order Runge-Kutta with stick and slip located inside a step.
#pragma once

#include <array>
#include <cstdint>

#include "robot/messages/units.hpp"
#include "sim/plant_model.hpp"

namespace biopsy::sim {

struct PlantInputs {
  double voltage = 0.0;         // V, signed, held over the step (Drive::Stack)
  double force = 0.0;           // N on plate A, up (Drive::Force)
  double external_force = 0.0;  // N, pushes plate A down
};

// What is integrated smoothly. SI.
struct Motion {
  double H = 0.0;                          // m, height of one pouch
  double x = 0.0, v = 0.0;                 // m, m/s, plate A and the needle tip
  double crept_lone = 0.0;                 // m, how far the tissue of the effect has crept,
  std::array<double, kMaxLayers> crept{};  // and each layer of the model's tissue
};

struct PlantState {
  double u_i = 0.0, u_o = 0.0;  // V, amplifier and stack
  double charge = 0.0;          // C, put out by the amplifier during the last step
  Motion motion;
  double zipped = 0.0;         // m, height memory of zipping hysteresis
  double x_max = 0.0;          // m, deepest position so far
  double reading = 0.0;        // m, lagged sensor
  std::uint64_t readings = 0;  // number of steps done: picks the noise
};

// At rest: no voltage, no motion.
PlantState at_rest(const PlantModel& model);

// The state after `duration` with inputs held. The voltage jumps at the beginning (eq. (2) at a sample).
PlantState step(const PlantModel& model, PlantState state, const PlantInputs& inputs, Seconds duration);

// What the laser reads now: x_A with the sensor's effects. m
double displacement_reading(const PlantModel& model, const PlantState& state);

// Plate B, x_B = n (H - H_0). m
double plate_b(const PlantModel& model, const PlantState& state);

// Amplifier's current between two samples, i = C1 d(u_i - u_o)/dt with u_i held. A
double current(const PlantModel& model, const PlantState& state);

// How many tissue layers' surfaces have been punctured.
int layers_entered(const PlantModel& model, const PlantState& state);

}  // namespace biopsy::sim
