// The plant: voltage in, motion out. step() is a function of its arguments and nothing else.
// Electrical part exact while the pouches keep their capacitance; mechanics by third-order Runge-Kutta with
// stick and slip located inside a step.
#pragma once

#include <array>
#include <cstdint>

#include "robot/common/units.hpp"
#include "sim/plant/plant_model.hpp"

namespace biopsy::sim {

struct PlantInputs {
  double voltage = 0.0;         // V, signed, held over the step (Drive::Stack)
  double force = 0.0;           // N on plate A, up (Drive::Force)
  double external_force = 0.0;  // N, pushes plate A down
  Grip grip{};                  // of the brake
};

// What is integrated smoothly. SI.
struct Motion {
  double H = 0.0;                          // m, height of one pouch
  double x = 0.0, v = 0.0;                 // m, m/s, plate A and the needle tip
  IntegratedStates integrated{};           // of the effects
  std::array<double, kMaxLayers> crept{};  // m, how far each layer of the model's tissue has crept
  std::array<double, kMostTerms> faded{};  // m, memory of each of the model's terms
};

struct PlantState {
  double time = 0.0;            // s since at rest
  double u_command = 0.0;       // V, of the amplifier
  double u_i = 0.0, u_o = 0.0;  // V, amplifier's output and stack
  double screened = 0.0;        // V, of the stack's, by retained charge
  double charge = 0.0;          // C, put out by the amplifier during the last step
  Motion motion;
  double x_max = 0.0;  // m, deepest position so far
  RememberedStates remembered;
  std::uint64_t readings = 0;  // number of steps done: picks the noise
};

// The state of one effect, by its type: m in state_of<PouchCreep>(state).
template <HasState Effect>
auto& state_of(auto& plant_state) {
  return state_in<Effect>(plant_state.motion.integrated, plant_state.remembered);
}

// At rest: no voltage, no motion.
PlantState at_rest(const PlantModel& model);

// Puts plate A at x (m) with speed v (m/s), in the middle of a run or at its beginning. Plate B moves along,
// as far as the pouches can, so that the spring keeps its stretch; sensor and play are as steady motion
// leaves them. The rest of the state (charge, time, creep, set, tissue cut open) stays.
void set_state(const PlantModel& model, PlantState& state, double x, double v);

// Moves the origin of x by dx (m): every position grows by it.
void shift(const PlantModel& model, PlantState& state, double dx);

// The state after `duration` with inputs held. The voltage jumps at the beginning (eq. (2) at a sample).
PlantState step(const PlantModel& model, PlantState state, const PlantInputs& inputs, Seconds duration);

// What the laser reads now: x_A with the sensor's effects. m
double displacement_reading(const PlantModel& model, const PlantState& state);

// Plate B, x_B = n (H - H_0 + what effects add to each pouch). m
double plate_b(const PlantModel& model, const PlantState& state);

// Amplifier's current between two samples, i = C1 d(u_i - u_o)/dt, with pouches that stand still. A
double current(const PlantModel& model, const PlantState& state);

// Upper estimate of how fast anything within the mechanics moves or fades, plate A staying within x_reach (m)
// of 0 and v_reach (m/s); 1/s. A tenth of its inverse is a good internal_step. Voltages and the sensor are
// solved exactly and do not count, nor do Stribeck's fall and Bouc-Wen's yielding, which stay bounded with
// any step.
double fastest_rate(const PlantModel& model, double x_reach = 5e-3, double v_reach = 0.05);

// How many tissue layers' surfaces have been punctured.
int layers_entered(const PlantModel& model, const PlantState& state);

}  // namespace biopsy::sim
