#include "sim/paper/figures/series_spring.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "sim/paper/figures/rows.hpp"
#include "sim/paper/open_loop.hpp"
#include "sim/paper/paper_targets.hpp"

namespace biopsy::sim::paper {
namespace {

constexpr double kDrive = 2.0;                                                          // Hz
constexpr double kVoltage = 6000.0;                                                     // V
constexpr double kPlotted = 3.0;                                                        // of the transmission
constexpr std::array kFrequencies{0.5, 1.0, 2.0, 2.5, 4.0, 5.0, 10.0};                  // Hz, of the drive
constexpr std::array kSprings{5.0, 10.0, 14.0, 25.0, 50.0, 80.0, 112.0, 140.0, 200.0};  // N/m

PlantModel without_friction(PlantModel stage) {
  stage.effects.hysteretic_spring.reset();
  stage.effects.coulomb_friction.reset();
  stage.effects.stribeck_friction.reset();
  stage.effects.lugre_friction.reset();
  stage.effects.load_dependent_friction.reset();
  return stage;
}

// Peak to peak of plate A over that of plate B, settled under the square wave.
double simulated(const PlantModel& stage, double frequency) {
  const double periods = std::ceil(2.0 * frequency);
  const OpenLoopRun run = run_open_loop(stage,
                                        {.amplitude = kVoltage,
                                         .frequency = frequency,
                                         .settle = std::ceil(20.0 * frequency) / frequency,
                                         .watch = periods / frequency,
                                         .period = 2.5e-3},
                                        true);
  return peak_to_peak(run.displacement) / std::max(1e-9, peak_to_peak(run.plate_b));
}

double closed_form(const PlantModel& stage, double frequency) {
  const Baseline& b = stage.baseline;
  return transmission(stage.mass_A(), b.k, b.c_k, b.c_s, 2.0 * frequency);
}

FigurePanel empty_panel(std::string title, std::string x_title, double low, double high) {
  FigurePanel panel{
      std::move(title), std::move(x_title), "plate A over plate B (1)", low, high, 0.0, kPlotted, true, {}};
  panel.curves = {{"closed form", {}, {}, true, false},
                  {"simulated, no dry friction", {}, {}, false, true},
                  {"simulated, with the guide's friction", {}, {}, false, true},
                  {"1: no filter", {low, high}, {1.0, 1.0}, true, false}};
  return panel;
}

void add_point(FigurePanel& panel, double x, const PlantModel& stage, double frequency) {
  const std::array ours{closed_form(stage, frequency), simulated(without_friction(stage), frequency),
                        simulated(stage, frequency)};
  for (std::size_t i = 0; i < ours.size(); ++i) {
    panel.curves[i].x.push_back(x);
    panel.curves[i].y.push_back(std::min(ours[i], kPlotted));
  }
}

}  // namespace

double transmission(double m, double k, double c_k, double c_s, double frequency) {
  const double w = 2.0 * std::numbers::pi * frequency;
  return std::abs(std::complex(k, w * c_k) / std::complex(k - m * w * w, w * (c_k + c_s)));
}

double resonance(double m, double k) {
  return std::sqrt(k / m) / (2.0 * std::numbers::pi);
}

void add_series_spring(const PaperModel& model, PaperFigure& figure) {
  PlantModel stage = model.stage;
  stage.weight = kWeight;
  const double m = stage.mass_A(), k = stage.baseline.k, f_0 = resonance(m, k), twice = 2.0 * kDrive;
  FigurePanel by_frequency =
      empty_panel(fmt::format("{:.0f} N/m, 50 g", k), "twice the drive's frequency over the resonance (1)",
                  2.0 * kFrequencies.front() / f_0, 2.0 * kFrequencies.back() / f_0);
  for (const double f : kFrequencies) add_point(by_frequency, 2.0 * f / f_0, stage, f);
  FigurePanel by_spring =
      empty_panel("2 Hz, 50 g", "stiffness of the spring (N/m)", kSprings.front(), kSprings.back());
  for (const double spring : kSprings) {
    PlantModel other = stage;
    other.baseline.k = spring;
    add_point(by_spring, spring, other, kDrive);
  }
  figure.panels.push_back(std::move(by_frequency));
  figure.panels.push_back(std::move(by_spring));
  const double free = simulated(without_friction(stage), kDrive), held = simulated(stage, kDrive);
  const double w = 2.0 * std::numbers::pi * twice, softest = 0.5 * m * w * w;
  figure.rows.push_back(shown_row(
      {"8a", "twice the drive's frequency, and the resonance of the spring with 50 g", "Hz"}, twice, f_0,
      fmt::format(
          "without damping a spring filters what is faster than sqrt(2) times its resonance, here {:.1f} Hz: "
          "it does {}filter a ripple of {:g} Hz",
          std::numbers::sqrt2 * f_0, twice > std::numbers::sqrt2 * f_0 ? "" : "not ", twice)));
  figure.rows.push_back(shown_row(
      {"8a", "50 g: plate A's motion over plate B's, without and with the guide's friction", "1"}, free, held,
      fmt::format(
          "{:.2f} by the closed form with damping. Where plate A is smooth at 2 Hz, friction holds it",
          closed_form(stage, kDrive))));
  figure.rows.push_back(shown_row(
      {"8a", "stiffness of the spring, and the largest that filters 2 Hz with 50 g", "N/m"}, k, softest,
      fmt::format("50 g would compress it by {:.0f} mm", 1e3 * kWeight * stage.baseline.g / softest)));
}

}  // namespace biopsy::sim::paper
