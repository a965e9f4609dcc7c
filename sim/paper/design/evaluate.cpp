#include "sim/paper/design/evaluate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "sim/plant/plant.hpp"
#include "sim/plant/pouch.hpp"

namespace biopsy::sim::design {
namespace {

constexpr double kSettle = 3.0;    // s: twelve time constants of the spring's oscillation, 2 m/c = 0.25 s
constexpr double kStep = 1e-3;     // s
constexpr double kWeight = 0.050;  // kg on the needle fixture, IV.F.2

double half_period(double frequency) {
  return 0.5 / frequency;
}

// Half the inner width of the pouch: one chamber, eq. (18)'s cross-section. m
double chamber(const StackDesign& design) {
  return 0.5e-3 * (design.side_mm - kSeam_mm);
}

// Time in which a viscous film of oil flows, up to a factor: (length / thickness)^2 / pressure, from
// Reynolds' lubrication equation. The share K is left out, which changes little between designs.
double oil_flow(const StackDesign& design) {
  const double thickness = design.oil_mL / (design.side_mm * 1e3 * chamber(design));
  const double field = design.drive_kV / design.film_um;
  return std::pow(chamber(design) / (thickness * field), 2);
}

void demand(DesignedStack& stack, double short_by, const std::string& words) {
  if (!(short_by > 0.0)) return;
  stack.broken.push_back(words);
  stack.shortfall += short_by;
}

// Length of the oil lens at rest: it must fit into the chamber, otherwise the pouch is thick without voltage.
// m
double rest_length(const Baseline& b) {
  const double flat = b.V0 / (b.L0 * b.H_0) - std::numbers::pi * b.H_0 / 4.0;  // S of eq. (18)
  return flat + std::numbers::pi * b.H_0 / 2.0;
}

void judge(DesignedStack& stack, const PlantModel& plant, const Demands& demands) {
  const StackFigures& f = stack.figures;
  const Baseline& b = plant.baseline;
  const StackDesign& design = stack.design;
  demand(stack, 1.0 - f.stroke_mm / demands.stroke_mm,
         fmt::format("stroke {:.1f} mm against {:.2g} N of tissue: less than {:.3g} mm", f.stroke_mm,
                     demands.push_N, demands.stroke_mm));
  demand(stack, 1.0 - f.breakdown_margin / demands.margin,
         fmt::format("field {:.0f} V/um: the film's strength is {:.2f} times that, required {:.2g}",
                     f.field_V_per_um, f.breakdown_margin, demands.margin));
  demand(stack, f.height_mm / demands.height_mm - 1.0,
         fmt::format("stack {:.1f} mm high: more than {:.3g} mm", f.height_mm, demands.height_mm));
  const double strain = f.stroke_mm / f.height_mm;
  demand(stack, strain / demands.strain - 1.0,
         fmt::format("strain {:.0f} %: more than {:.3g} %", 100.0 * strain, 100.0 * demands.strain));
  demand(stack, rest_length(b) / chamber(design) - 1.0,
         fmt::format("the oil does not lie flat at rest: it needs {:.1f} mm of a chamber of {:.1f} mm",
                     1e3 * rest_length(b), 1e3 * chamber(design)));
}

}  // namespace

StackDesign design_of(const PlantModel& known) {
  StackDesign design;
  design.film_um = 0.5e6 * known.baseline.d_film;
  design.pouches = known.baseline.n;
  design.spring_N_per_mm = 1e-3 * known.baseline.k;
  return design;
}

PlantModel plant_of(const PlantModel& known, const StackDesign& design) {
  PlantModel plant = known;
  Baseline& b = plant.baseline;
  const Baseline& old = known.baseline;
  b.V0 = old.V0 * design.oil_mL / kPaperOil_mL;
  b.L0 = old.L0 * design.side_mm / kPaperSide_mm;
  b.d_film = 2e-6 * design.film_um;
  b.n = design.pouches;
  b.tau_h = old.tau_h * oil_flow(design) / oil_flow(design_of(known));
  b.k = 1e3 * design.spring_N_per_mm;
  const double larger = std::pow(design.side_mm / kPaperSide_mm, 2) * (b.n / old.n) * (old.d_film / b.d_film);
  const double old_C2 = old.C1 * (1.0 - old.K) / old.K;
  const double R = old.tau / (old.C1 + old_C2) / larger, C2 = old_C2 * larger;
  b.K = b.C1 / (b.C1 + C2);
  b.tau = R * (b.C1 + C2);
  Effects& e = plant.effects;
  if (e.zipping_capacitance) e.zipping_capacitance->growth *= (1.0 - b.K) / (1.0 - old.K);  // of C2 alone
  e.zipping_hysteresis.reset();
  e.coulomb_friction.reset();
  e.stribeck_friction.reset();
  e.lugre_friction.reset();
  e.load_dependent_friction.reset();
  e.hysteretic_spring.reset();
  e.sensor_noise.reset();
  e.sensor_drift.reset();
  plant.weight = kWeight;
  return plant;
}

double guaranteed_strength(double film_um) {
  struct Film {
    double um, V_per_um;
  };
  constexpr std::array<Film, 5> kFilms{{{12.7, 118}, {25.4, 236}, {50.8, 197}, {76.2, 177}, {127, 118}}};
  if (film_um <= kFilms.front().um) return kFilms.front().V_per_um;
  for (std::size_t i = 1; i < kFilms.size(); ++i)
    if (film_um <= kFilms[i].um)
      return std::lerp(kFilms[i - 1].V_per_um, kFilms[i].V_per_um,
                       (film_um - kFilms[i - 1].um) / (kFilms[i].um - kFilms[i - 1].um));
  return kFilms.back().V_per_um;
}

double bandwidth(const PlantModel& plant, double P, double load) {
  using std::numbers::pi;
  const Baseline& b = plant.baseline;
  const double slope = equilibrium(b, P, load).slope, mass = plant.mass_A();
  const auto follows = [&](double f) {
    const std::complex<double> s(0.0, 2.0 * pi * f), spring = b.k + b.c_k * s;
    const std::complex<double> inertia = mass * s * s + b.c_s * s, both = inertia + spring;
    return std::abs(spring / both / (1.0 + b.tau_h * s - slope * b.n * spring * inertia / both));
  };
  constexpr double kRatio = 1.01, kHighest = 100.0;
  double f = 0.05;
  while (f < kHighest && follows(f) >= std::numbers::sqrt2 / 2.0) f *= kRatio;
  return f;
}

double stack_height_mm(const StackDesign& design) {
  const double chambers_mm2 = (design.side_mm - kSeam_mm) * design.side_mm;
  const double lens = 1.5 * 1e3 * design.oil_mL / chambers_mm2;  // 1.5 times its mean height in the middle
  return design.pouches * (lens + 2e-3 * design.film_um);
}

Swing steady_swing(const PlantModel& plant, double amplitude, double push) {
  const Baseline& b = plant.baseline;
  const double kept = std::exp(-half_period(kDriveFrequency) / b.tau);
  PlantState state = at_rest(plant);
  state.u_i = -amplitude;  // periodic state: K_2 of eq. (17)
  state.u_o = -2.0 * b.K * kept / (1.0 + kept) * amplitude;
  const auto half = static_cast<int>(std::lround(half_period(kDriveFrequency) / kStep));
  const int steps = static_cast<int>(std::lround(kSettle / kStep)) / (2 * half) * 2 * half, cycle = 2 * half;
  double low = 0.0, high = 0.0, sum = 0.0;
  for (int i = 0; i < steps + cycle; ++i) {
    const double voltage = i / half % 2 == 0 ? amplitude : -amplitude;
    state = step(plant, state, {.voltage = voltage, .external_force = push}, Seconds(kStep));
    if (i < steps) continue;
    low = i == steps ? state.motion.x : std::min(low, state.motion.x);
    high = i == steps ? state.motion.x : std::max(high, state.motion.x);
    sum += state.motion.x;
  }
  return {sum / cycle, high - low};
}

DesignedStack evaluate(const PlantModel& known, const StackDesign& design, const Demands& demands) {
  const PlantModel plant = plant_of(known, design);
  const Baseline& b = plant.baseline;
  const double amplitude = 1e3 * design.drive_kV, load = (plant.mass_A() + b.m_B) * b.g + demands.push_N;
  const Swing swing = steady_swing(plant, amplitude, demands.push_N);
  DesignedStack stack{design, {}, {}, 0.0};
  StackFigures& f = stack.figures;
  f.stroke_mm = 1e3 * swing.mean;
  f.ripple_mm = 1e3 * swing.peak_to_peak;
  f.bandwidth_Hz = bandwidth(plant, pressure(b, b.K * amplitude), load);
  f.field_V_per_um = 1e-6 * amplitude / b.d_film;  // K = 1: nothing but the films holds the voltage
  f.breakdown_margin = guaranteed_strength(design.film_um) / f.field_V_per_um;
  f.height_mm = stack_height_mm(design);
  judge(stack, plant, demands);
  return stack;
}

}  // namespace biopsy::sim::design
