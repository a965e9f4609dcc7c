#include "sim/paper/tuning/tuning_panels.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "sim/paper/figures/loop_panels.hpp"
#include "sim/paper/tuning/linear_stage.hpp"
#include "sim/paper/tuning/score.hpp"

namespace biopsy::sim::tuning {
namespace {

constexpr double kFrom = 0.05, kTo = 100.0;   // Hz
constexpr std::size_t kEvery = 6;             // of frequencies()
constexpr paper::TimeSpan kSteps{4.5, 15.5};  // s

FigurePanel bode_panel(std::string title, std::string y_title) {
  FigurePanel panel;
  panel.title = std::move(title);
  panel.x_title = "frequency, Hz";
  panel.y_title = std::move(y_title);
  panel.x_low = kFrom;
  panel.x_high = kTo;
  panel.logarithmic_x = true;
  return panel;
}

// One loop, in both panels.
void add_loop(FigurePanel& magnitude, FigurePanel& phase, const PlantModel& model, double depth,
              const EvaluatedGains& evaluated) {
  FigureCurve size, angle;
  size.name = angle.name = fmt::format("{}, {:.0f} mm", evaluated.name, depth);
  size.dashed = angle.dashed = evaluated.gains.proportional_V_per_mm == PiGains{}.proportional_V_per_mm;
  const LinearStage stage = linearised(model, depth);
  double before = -90.0;
  for (std::size_t i = 0; i < frequencies().size(); i += kEvery) {
    const double omega = frequencies()[i], hertz = omega / (2.0 * std::numbers::pi);
    if (hertz > kTo) break;
    const std::complex<double> loop = response(stage, omega) * controller(evaluated.gains, omega);
    double degrees = std::arg(loop) * 180.0 / std::numbers::pi;
    degrees -= 360.0 * std::round((degrees - before) / 360.0);
    before = degrees;
    if (hertz < kFrom) continue;
    size.x.push_back(hertz), size.y.push_back(20.0 * std::log10(std::abs(loop)));
    angle.x.push_back(hertz), angle.y.push_back(degrees);
  }
  magnitude.curves.push_back(std::move(size));
  phase.curves.push_back(std::move(angle));
}

FigureCurve level(double y) {
  return {"", {kFrom, kTo}, {y, y}, true, false};
}

FigurePanel step_panel(const PlantModel& model, const Tuning& tuning) {
  FigurePanel panel;
  for (const EvaluatedGains& one : tuning.evaluated) {
    const paper::Course course = steps(model, {one.gains, one.feed ? &model : nullptr, one.speed});
    if (panel.curves.empty()) {
      panel = paper::displacement_panel("2 to 8 mm and back", course, kSteps);
      panel.curves.pop_back();
    }
    panel.curves.push_back(paper::drawn(one.name, course, course.plate_a, kSteps));
  }
  paper::fit_height(panel);
  return panel;
}

}  // namespace

std::vector<FigurePanel> tuning_panels(const PlantModel& model, const Tuning& tuning) {
  FigurePanel magnitude = bode_panel("open loop, magnitude", "dB");
  FigurePanel phase = bode_panel("open loop, phase", "degrees");
  for (const EvaluatedGains& one : tuning.evaluated) {
    if (one.feed) continue;
    add_loop(magnitude, phase, model, tuning.depths.front(), one);
    add_loop(magnitude, phase, model, tuning.depths.back(), one);
  }
  magnitude.curves.push_back(level(0.0));
  phase.curves.push_back(level(-180.0));
  magnitude.y_low = -60.0, magnitude.y_high = 60.0;
  phase.y_low = -360.0, phase.y_high = 0.0;
  return {step_panel(model, tuning), magnitude, phase};
}

}  // namespace biopsy::sim::tuning
