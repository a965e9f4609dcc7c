#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/sim/gap/generator/hidden_forces.hpp"
#include "tests/sim/gap/generator/hidden_physics.hpp"
#include "tests/sim/gap/generator/hidden_stack.hpp"

namespace biopsy::hidden {
namespace {

// Everything plate A did, one sample a substep: the sensor reads it afterwards.
struct Track {
  double step = 0.0;
  std::vector<double> x;

  double at(double t) const {
    const double place = std::clamp(t / step, 0.0, static_cast<double>(x.size() - 1));
    const std::size_t i = std::min(static_cast<std::size_t>(place), x.size() - 2);
    const double part = place - static_cast<double>(i);
    return (1.0 - part) * x[i] + part * x[i + 1];
  }
};

void loosen(Track& track, double radius) {  // what is measured hangs in a free play
  double carried = 0.0, from = 0.0;
  for (double& x : track.x) {
    const double to = x;
    carried = follow(carried, from, to, radius);
    from = to;
    x = carried;
  }
}

std::vector<double> read_sensor(Track track, const HiddenPhysics& p, const Program& program, Dice dice) {
  if (p.play > 0.0) loosen(track, p.play);
  std::vector<double> reading(program.input.size());
  double wander = p.speckle * dice.normal();
  const double fading = std::exp(-program.period / 0.7);
  for (std::size_t row = 0; row < reading.size(); ++row) {
    const double t = static_cast<double>(row) * program.period;
    const double jitter = p.clock_jitter > 0.0 ? p.clock_jitter * dice.normal() : 0.0;
    const double x = track.at(t - p.delay + jitter);
    if (p.speckle > 0.0)
      wander = fading * wander + std::sqrt(1.0 - fading * fading) * p.speckle * dice.normal();
    reading[row] = x * (1.0 + p.gain_error) + p.offset + p.drift * t + wander +
                   p.cyclic_error * std::sin(2.0 * std::numbers::pi * x / 0.9e-3);
  }
  return reading;
}

double equilibrium_height(const StageNumbers& b, double load, double pressure) {
  if (pressure <= 0.0) return b.H_0;
  const double s = load / (b.L0 * pressure), q = std::numbers::pi * b.V0 / b.L0;
  return std::max(b.H_0,
                  2.0 / std::numbers::pi * q / (std::sqrt(s * s + q) + s));  // no cancellation at small P
}

// Plates, spring and pouches; one substep is a leapfrog with everything evaluated in its middle.
struct Stage {
  StageNumbers b;
  HiddenPhysics p;
  double mass;
  HiddenForces forces;
  HiddenFilms films;
  double x = 0.0, v = 0.0, height, flow = 0.0, pull = 0.0;  // pull: last acceleration, flow: dH/dt

  Stage(const StageNumbers& numbers, const HiddenPhysics& physics, double weight, std::uint64_t seed)
      : b(numbers),
        p(physics),
        mass(numbers.fixture + weight + physics.extra_mass),
        forces(physics, mass, seed),
        films(numbers, physics),
        height(numbers.H_0) {}

  double oil_time(double t, double rate) const {
    return b.tau_h * (1.0 + p.thickening * t) * (rate < 0.0 ? 1.0 + p.slow_fall : 1.0);
  }

  void advance(double t, double pressure, double volts, double push, double h) {
    const double x_mid = x + 0.5 * h * v, v_mid = v + 0.5 * h * pull, h_mid = height + 0.5 * h * flow;
    const double bent = b.n * (h_mid - b.H_0) - x_mid;
    const double elastic = mass * b.g + b.k * bent + forces.spring(b.k, bent, b.n * flow - v_mid, h);
    double spring = 0.0, equilibrium = b.H_0;
    for (int pass = 0; pass < 3;
         ++pass) {  // load and flow depend on each other through c_k; contracts by 100
      spring = std::max(0.0, elastic + b.c_k * (b.n * flow - v_mid));
      equilibrium = equilibrium_height(b, spring + b.m_B * b.g, pressure);
      const double gap = films.aim(equilibrium) - h_mid;
      flow = gap / oil_time(t, gap);
    }
    films.remember(equilibrium, h_mid, h);
    pull = (spring - mass * b.g - b.c_s * v_mid - push - forces.resisting(t, x_mid, v_mid, spring, h) +
            (p.law ? p.law(x_mid, v_mid, volts) : 0.0)) /
           mass;
    v += h * pull;
    x = x_mid + 0.5 * h * v;
    height += h * flow;
  }
};

int substeps(double period, double substep) {
  return std::max(1, static_cast<int>(std::ceil(period / substep - 1e-9)));
}

}  // namespace

double Dice::normal() {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * uniform());
}

Trace run_stage(const StageNumbers& numbers, const HiddenPhysics& physics, const Program& program,
                std::uint64_t seed, double substep) {
  const int pieces = substeps(program.period, substep);
  const double h = program.period / pieces;
  HiddenSupply supply(numbers, physics, seed);
  Stage stage(numbers, physics, program.weight, seed);
  Track track{h, {0.0}};
  Trace out;
  double current = 0.0;
  for (std::size_t row = 0; row < program.input.size(); ++row) {
    out.plate_b.push_back(numbers.n * (stage.height - numbers.H_0));
    out.current.push_back(current);  // just before the new voltage: the jump itself is over within the period
    supply.command(program.input[row]);
    for (int i = 0; i < pieces; ++i) {
      const double t = static_cast<double>(row) * program.period + (i + 0.5) * h;
      supply.advance(t, 0.5 * h);
      supply.zip(stage.height - numbers.H_0);
      stage.advance(t, supply.pressure(), supply.voltage(), program.push[row], h);
      const double before = supply.charge_moved();
      supply.advance(t, 0.5 * h);
      current = (supply.charge_moved() - before) / (0.5 * h);
      track.x.push_back(stage.x);
    }
  }
  out.displacement = read_sensor(std::move(track), physics, program, Dice(seed ^ 0x5E45));
  return out;
}

Trace run_mechanism(const MechanismNumbers& numbers, const HiddenPhysics& physics, const Program& program,
                    std::uint64_t seed, double substep) {
  const int pieces = substeps(program.period, substep);
  const double h = program.period / pieces, mass = numbers.m + physics.extra_mass;
  HiddenForces forces(physics, mass, seed);
  Track track{h, {0.0}};
  double x = 0.0, v = 0.0, pull = 0.0;
  for (std::size_t row = 0; row < program.input.size(); ++row)
    for (int i = 0; i < pieces; ++i) {
      const double t = static_cast<double>(row) * program.period + (i + 0.5) * h;
      const double x_mid = x + 0.5 * h * v, v_mid = v + 0.5 * h * pull;
      const double spring = numbers.k * x_mid + forces.spring(numbers.k, x_mid, v_mid, h);
      pull = (program.input[row] - numbers.c_s * v_mid - spring - program.push[row] -
              forces.resisting(t, x_mid, v_mid, program.input[row], h)) /
             mass;
      v += h * pull;
      x = x_mid + 0.5 * h * v;
      track.x.push_back(x);
    }
  Trace out;
  out.displacement = read_sensor(std::move(track), physics, program, Dice(seed ^ 0x5E45));
  return out;
}

}  // namespace biopsy::hidden
