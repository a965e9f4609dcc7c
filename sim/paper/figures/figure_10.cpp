// Fig. 10: plates A and B while a displacement is held, IV.D.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "robot/control/square_wave.hpp"
#include "sim/paper/figures/figures.hpp"
#include "sim/paper/figures/loop_panels.hpp"
#include "sim/paper/figures/loop_scores.hpp"
#include "sim/paper/figures/rows.hpp"
#include "sim/paper/paper_targets.hpp"

namespace biopsy::sim::paper {
namespace {

constexpr double kHeld = 5.0;    // mm, as in Fig. 11; the text does not say
constexpr double kFrom = 6.0;    // s
constexpr double kUntil = 10.0;  // s: sixteen reversals of the square wave

// Peak to peak of the mean over all half periods of the square wave: the part synchronous with the drive,
// without noise and asynchronous motion. mm
double synchronous_motion(const Course& course, const std::vector<double>& values) {
  std::array<double, control::kHalfPeriod_ticks> mean{};
  for (std::size_t k = 0; k < values.size(); ++k)
    if (course.time[k] >= kFrom) mean[k % mean.size()] += values[k];
  const auto [low, high] = std::minmax_element(mean.begin(), mean.end());
  return (*high - *low) / ((kUntil - kFrom) / (1e-3 * control::kHalfPeriod_ticks));
}

}  // namespace

PaperFigure figure_10(const PaperModel& model) {
  PlantModel stage = model.stage;
  stage.weight = kWeight;
  stage.effects.sensor_noise.reset();  // of two lasers it would be the same on both plates, and hide them
  const Course course =
      follow(stage, {.target = [](double) { return kHeld; }, .seconds = kUntil, .loads = {}},
             paper_loop(model.loop_period));
  const double a = span(course, course.plate_a, kFrom, kUntil).width();
  const double b = span(course, course.plate_b, kFrom, kUntil).width();
  const double drive_a = synchronous_motion(course, course.plate_a),
               drive_b = synchronous_motion(course, course.plate_b);
  PaperFigure figure{"10",
                     "Plates A and B while 5 mm is held",
                     "Plate B moves to keep plate A in place, and goes with the reversals; plate A less.",
                     {},
                     {}};
  FigurePanel panel = displacement_panel("settled", course, {kFrom, kUntil});
  panel.curves.push_back(drawn("plate B", course, course.plate_b, {kFrom, kUntil}));
  fit_closely(panel);
  figure.panels = {panel};
  figure.rows.push_back(
      trend_row("10", "plate A is smoother than plate B", b / a - 1.0,
                fmt::format("peak to peak: A {:.3f} mm, B {:.3f} mm, ratio {:.2f}; the paper gives no number",
                            a, b, b / a)));
  figure.rows.push_back(shown_row({"10", "peak to peak of plate B over that of plate A", "1"}, 1.0, b / a,
                                  "1: no smoother; the paper gives no number"));
  figure.rows.push_back(
      trend_row("10", "plate B goes with the square wave's reversals, plate A less", drive_b / drive_a - 1.0,
                fmt::format("averaged over the half periods, peak to peak: A {:.3f} mm, B {:.3f} mm", drive_a,
                            drive_b)));
  return figure;
}

}  // namespace biopsy::sim::paper
