#include "sim/paper/open_loop.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace biopsy::sim::paper {
namespace {

constexpr double kRigid = 20e3;     // N/m: three hundred times the stack's own stiffness
constexpr double kRigidStep = 0.8;  // times 1/fastest rate: a third of the integrator's stability limit
constexpr double kShortest = 6.0;   // s in which pouches and plate settle under the square wave

// Periodic state at the beginning of a half period with +amplitude: eq. (17) for the stack, and for the
// retained charge the solution of its equation with s(a) = -s(0), a half a period.
void start_settled(const PlantModel& model, const OpenLoopDrive& drive, PlantState& state) {
  const Baseline& b = model.baseline;
  const double a = 0.5 / drive.frequency, left = std::exp(-a / b.tau);
  const double upper = 2.0 * b.K / (1.0 + left) * drive.amplitude;  // eq. (16)
  state.u_i = state.u_command = -drive.amplitude;
  state.u_o = -upper * left;
  const auto& charge = model.effects.charge_retention;
  if (!charge) return;
  const double apart = charge->time / b.tau - 1.0;
  const double time = std::abs(apart) < 1e-6 ? (1.0 + 1e-6) * b.tau : charge->time;  // else it divides by 0
  const double kept = std::exp(-a / time);
  const double driven = (left - kept) / (1.0 - time / b.tau);
  state.screened = -charge->share * upper * driven / (1.0 + kept);
}

}  // namespace

double polarity_at(double time, double frequency) {
  if (frequency <= 0.0) return 1.0;
  constexpr double kEarly = 1e-6;  // of half a period: a switch is not missed by rounding
  return std::fmod(std::floor(time * 2.0 * frequency + kEarly), 2.0) == 0.0 ? 1.0 : -1.0;
}

OpenLoopRun run_open_loop(const PlantModel& model, const OpenLoopDrive& drive, bool skip_settling) {
  PlantModel noiseless = model;
  noiseless.effects.sensor_noise.reset();
  PlantState state = at_rest(noiseless);
  double settle = drive.settle;
  if (skip_settling && drive.frequency > 0.0) {
    start_settled(noiseless, drive, state);
    settle = std::min(settle, std::ceil(2.0 * kShortest * drive.frequency) / (2.0 * drive.frequency));
  }
  const auto waits = static_cast<std::size_t>(std::lround(settle / drive.period));
  const auto rows = static_cast<std::size_t>(std::lround(drive.watch / drive.period));
  OpenLoopRun run;
  for (std::size_t i = 0; i < waits + rows; ++i) {
    const double now = static_cast<double>(i) * drive.period;
    const double voltage = drive.amplitude * polarity_at(now, drive.frequency);
    state = step(noiseless, state, {.voltage = voltage}, Seconds(drive.period));
    if (i < waits) continue;
    run.time.push_back(now + drive.period + (drive.settle - settle));
    run.displacement.push_back(1e3 * displacement_reading(noiseless, state));
    run.plate_b.push_back(1e3 * plate_b(noiseless, state));
    run.voltage.push_back(voltage);
    run.current.push_back(state.charge / drive.period);
  }
  return run;
}

PlantModel with_rigid_pole(PlantModel stage) {
  stage.baseline.k = kRigid;
  stage.effects.spring_hardening.reset();
  stage.effects.asymmetric_spring.reset();
  stage.effects.piecewise_spring.reset();
  stage.internal_step = std::min(stage.internal_step, kRigidStep / fastest_rate(stage));
  return stage;
}

namespace {

// One slider instead of two; friction that is elastic before it slides yields at the same displacement.
void halve_guide(PlantModel& stage) {
  stage.baseline.c_s *= 0.5;
  if (auto& dry = stage.effects.coulomb_friction) dry->force *= 0.5;
  if (auto& dry = stage.effects.stribeck_friction) {
    dry->sliding *= 0.5;
    dry->breakaway *= 0.5;
  }
  if (auto& spring = stage.effects.hysteretic_spring) spring->stiffness *= 0.5;
  if (auto& loaded = stage.effects.load_dependent_friction) loaded->share *= 0.5;
  if (auto& bristles = stage.effects.lugre_friction) {
    bristles->sliding *= 0.5;
    bristles->breakaway *= 0.5;
    bristles->stiffness *= 0.5;
  }
}

}  // namespace

PlantModel plate_on_stack(PlantModel stage, double pouches, double weight) {
  stage.baseline.n = pouches;
  stage.baseline.m_B = 0.0;
  stage.weight = weight;
  halve_guide(stage);
  return with_rigid_pole(std::move(stage));
}

double guide_friction(const PlantModel& stage) {
  const Effects& e = stage.effects;
  double force = 0.0;
  if (e.coulomb_friction) force += e.coulomb_friction->force;
  if (e.stribeck_friction) force += e.stribeck_friction->breakaway;
  if (const auto& spring = e.hysteretic_spring) force += (1.0 - spring->across) * spring->pull(spring->yield);
  if (e.lugre_friction) force += e.lugre_friction->steady(0.0);
  if (e.load_dependent_friction)
    force += e.load_dependent_friction->share * stage.mass_A() * stage.baseline.g;
  return force;
}

double peak_to_peak(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

}  // namespace biopsy::sim::paper
