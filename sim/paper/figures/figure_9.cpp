// Fig. 9a,b: 0.05 Hz square wave and sine at 50 g, IV.D.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/paper/figures/figures.hpp"
#include "sim/paper/figures/loop_panels.hpp"
#include "sim/paper/figures/loop_scores.hpp"
#include "sim/paper/figures/rows.hpp"
#include "sim/paper/open_loop.hpp"
#include "sim/paper/paper_targets.hpp"

namespace biopsy::sim::paper {
namespace {

constexpr double kPeriods = 2.0;
constexpr double kLowShare = 0.25;     // of the sine's range: low targets
constexpr double kNoVoltage = 0.1;     // kV
constexpr double kNotZero = 0.4;       // mm: hardly distinguishable from 0 in the figure
constexpr double kSquareRmse = 0.077;  // mm, IV.D

Course slow_course(const PaperModel& model, const OfTime& target, double periods = kPeriods) {
  PlantModel stage = model.stage;
  stage.weight = kWeight;
  return follow(stage, {.target = target, .seconds = periods / kSlowest, .loads = {}},
                paper_loop(model.loop_period));
}

// The paper's RMSE can be over everything or over settled windows: which one follows by arithmetic.
std::string settled_note(const Course& course) {
  const double step = kSquareHigh - kSquareLow, half = 0.5 / kSlowest;
  const double longest = 2.0 * half * (0.077 / step) * (0.077 / step);  // S^2 tau/2 over half a period
  return fmt::format(
      "settled: from {:.0f} s after a jump of the target. The paper's 0.077 mm can only be this one: over "
      "everything, edges of {:.0f} mm every {:.0f} s that decay with a time constant tau give {:.0f} "
      "sqrt(tau/{:.0f} s) mm, which is 0.077 mm for tau = {:.1f} ms, faster than the oil (here over "
      "everything: {:.2f} mm); {}",
      kSettling, step, half, step, 2.0 * half, 1e3 * longest, rmse(course), kTargetsNote);
}

void add_square_rows(PaperFigure& figure, const Course& course) {
  figure.rows.push_back(number_row({"9a", "RMSE over settled windows", "mm"}, kSquareRmse,
                                   rmse_settled(course), settled_note(course)));
  figure.rows.push_back(shown_row({"9a", "RMSE over everything, edges included", "mm"}, 0.077, rmse(course),
                                  "beside the paper's number, which cannot be this one: see the row above"));
  figure.rows.push_back(at_most_row({"9a", "largest overshoot of a rising edge, of the target", "%"}, 10.0,
                                    overshoot_percent(course),
                                    "highest reading after a rising edge, noise included: where IV.D gives a "
                                    "number it is \"the maximum actual value\" over the target's"));
  figure.rows.push_back(shown_row({"9a", "largest overshoot of a falling edge, of the step", "%"}, 10.0,
                                  undershoot_percent(course),
                                  "not judged: of falling edges the paper says only that they overshoot "
                                  "occasionally, and largely (IV.D, for 9c)"));
  add_window_rows(figure.rows, "9a", "", kSquareRmse, course);
  const double rise = mean_travel(course, true), fall = mean_travel(course, false);
  figure.rows.push_back(trend_row(
      "9a", "falling edges lag behind rising ones", visible_lag(course),
      fmt::format(
          "90 % of the way takes {:.0f} ms up and {:.0f} ms down; a reader sees {:.0f} ms, the width of a "
          "line in a panel of {:.0f} s. At 0 V only weight pulls",
          1e3 * rise, 1e3 * fall, 1e3 * kLineShare * course.time.back(), course.time.back())));
}

// Stick-slip: while the sine moves at more than half of its largest speed, plate A stands (slower than
// kStands of the target) and runs (faster than kRuns of it). Speeds between means over half of kWindow, so
// that the laser's noise counts for little. Margin: by how much the less marked of the two is passed.
constexpr double kWindow = 0.1;  // s
constexpr double kStands = 0.2, kRuns = 1.5;

struct StickSlip {
  double slowest = 1e9, fastest = 0.0;  // of the target's speed

  double margin() const { return std::min(1.0 - slowest / kStands, fastest / kRuns - 1.0); }
};

StickSlip stick_slip(const Course& course) {
  const auto ticks = static_cast<std::size_t>(std::lround(kWindow / 1e-3));
  const double quickest = std::numbers::pi * (kSineHigh - kSineLow) * kSlowest;  // mm/s
  const auto speed = [&](const std::vector<double>& values, std::size_t k) {
    double before = 0.0, after = 0.0;
    for (std::size_t i = 0; i < ticks / 2; ++i) before += values[k + i], after += values[k + ticks / 2 + i];
    return (after - before) / static_cast<double>(ticks / 2) / (0.5 * kWindow);
  };
  StickSlip out;
  for (std::size_t k = 0; k + ticks <= course.time.size(); k += ticks / 4) {
    const double asked = speed(course.target, k);
    if (course.time[k] < kSettling || std::abs(asked) < 0.5 * quickest) continue;
    const double followed = speed(course.plate_a, k) / asked;
    out.slowest = std::min(out.slowest, std::abs(followed));
    out.fastest = std::max(out.fastest, followed);
  }
  return out;
}

// What keeps plate A above the sine's lowest point.
std::string floor_note(const PlantModel& stage, const Course& course) {
  const double middle = 1.0 / kSlowest, at_lowest[] = {middle - 0.5, middle + 0.5};
  const double left = mean_between(course, course.plate_a, at_lowest[0], at_lowest[1]) - kSineLow;
  const double kilovolts = mean_between(course, course.amplitude, at_lowest[0], at_lowest[1]);
  std::string note = fmt::format("at the target's lowest point plate A is {:.2f} mm above it, at {:.2f} kV",
                                 left, kilovolts);
  if (guide_friction(stage) > 0.0 && left > kNotZero && kilovolts < kNoVoltage)
    note +=
        ": the friction required by Fig. 8b's hysteresis holds it there, no controller can pull it down, and "
        "on the way up the voltage has to rise from 0 before the plate breaks away";
  return note;
}

void add_sine_rows(PaperFigure& figure, const PlantModel& stage, const Course& course, const Course& square) {
  figure.rows.push_back(number_row(
      {"9b", "RMSE over everything", "mm"}, 0.211, rmse(course),
      fmt::format(
          "the paper says \"total RMSE\", and a sine has no edges: over settled windows it is {:.3f} mm; "
          "{}; {}",
          rmse_settled(course), floor_note(stage, course), kTargetsNote)));
  figure.rows.push_back(shown_row({"9b", "RMSE over settled windows", "mm"}, 0.211, rmse_settled(course),
                                  "the other reading of the row above"));
  figure.rows.push_back(number_row({"9b", "RMSE over that of the square wave (9a)", "1"}, 3.0,
                                   rmse(course) / rmse_settled(square),
                                   "\"3 times that of square waves\" (IV.D); the printed numbers give 2.74"));
  const double edge = kSineLow + kLowShare * (kSineHigh - kSineLow);
  const double low = rmse_between(course, kSineLow, edge), rest = rmse_between(course, edge, kSineHigh + 1.0);
  figure.rows.push_back(trend_row(
      "9b", "low targets are followed worse", low / rest - 1.0,
      fmt::format("RMSE {:.3f} mm where the target is below {:.0f} mm, {:.3f} mm above", low, edge, rest)));
  const StickSlip slip = stick_slip(course);
  figure.rows.push_back(trend_row(
      "9b", "plate A sticks and slips", slip.margin(),
      fmt::format(
          "where the target moves at more than half of its largest speed, plate A moves at {:.2f} to {:.2f} "
          "times its speed, over {:g} s; asked for: below {:g} and above {:g}",
          slip.slowest, slip.fastest, 0.5 * kWindow, kStands, kRuns)));
}

// Sensitivity of the missed row to the assumed lowest point.
PaperRow raised_row(const PaperModel& model) {
  const Course course = slow_course(model, sine_target(kNotZero, kSineHigh, kSlowest));
  return shown_row(
      {"9b", fmt::format("RMSE over everything, were the sine's lowest point {} mm", kNotZero), "mm"}, 0.211,
      rmse(course), "the lowest point is not in the paper's text");
}

PaperRow first_period_row(const PaperModel& model) {
  const Course course = slow_course(model, sine_target(kSineLow, kSineHigh, kSlowest), 1.0);
  return shown_row({"9b", "RMSE over the first period alone", "mm"}, 0.211, rmse(course),
                   "from rest; two periods are judged, and how many the paper counts is not in its text");
}

PaperFigure slow_figure(std::string number, std::string title, std::string sentence, const Course& course) {
  PaperFigure figure{std::move(number), std::move(title), std::move(sentence), {}, {}};
  const TimeSpan all{0.0, kPeriods / kSlowest};
  figure.panels = {displacement_panel("displacement", course, all),
                   voltage_panel("applied voltage", course, all)};
  return figure;
}

}  // namespace

PaperFigure figure_9a(const PaperModel& model) {
  const Course course = slow_course(model, square_target(kSquareLow, kSquareHigh, kSlowest));
  PaperFigure figure = slow_figure(
      "9a", "Square wave of 0.05 Hz under the PI loop, 50 g",
      "A square wave with a constant offset: plate A at the edges, and on both plateaus.", course);
  add_square_rows(figure, course);
  return figure;
}

PaperFigure figure_9b(const PaperModel& model) {
  const Course course = slow_course(model, sine_target(kSineLow, kSineHigh, kSlowest));
  PaperFigure figure = slow_figure(
      "9b", "Sine of 0.05 Hz under the PI loop, 50 g",
      "A target without edges, down to a depth of 0, where the voltage is at its lower limit.", course);
  add_sine_rows(figure, model.stage, course,
                slow_course(model, square_target(kSquareLow, kSquareHigh, kSlowest)));
  if (!model.brief) {
    figure.rows.push_back(raised_row(model));
    figure.rows.push_back(first_period_row(model));
  }
  return figure;
}

}  // namespace biopsy::sim::paper
