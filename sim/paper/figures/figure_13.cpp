// Fig. 13: needle through muscle, gap and liver, 50 g on its fixture, IV.F.2.
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <initializer_list>

#include "sim/paper/figures/figures.hpp"
#include "sim/paper/figures/loop_panels.hpp"
#include "sim/paper/figures/loop_scores.hpp"
#include "sim/paper/figures/rows.hpp"
#include "sim/paper/paper_targets.hpp"

namespace biopsy::sim::paper {
namespace {

constexpr double kGapTarget = 2.5;                       // mm
constexpr double kLiverFirst = 2.0, kLiverTarget = 3.5;  // mm
constexpr double kHold = 8.0;                            // s on each target

// RMSE by the edges alone: the paper's number cannot include them.
std::string settled_note(const Course& course, std::initializer_list<double> steps) {
  constexpr double tau = 0.1;  // s, far faster than the 1 s of IV.E
  double sum = 0.0;
  for (const double step : steps) sum += step * step * 0.5 * tau;
  return fmt::format(
      "over settled windows: the edges alone, decaying with as little as {} s, give {:.2f} mm over "
      "everything "
      "(here: {:.2f} mm), more than the paper's number",
      tau, std::sqrt(sum / course.time.back()), rmse(course));
}

PlantModel with_needle(const PaperModel& model) {
  PlantModel stage = model.stage;
  stage.weight = kWeight;
  stage.tissue = model.needle.tissue;
  return stage;
}

// The needle ends in the gap: through the muscle, at most touching the liver.
double gap_margin(const Needle& needle, const Course& course) {
  const double end = course.plate_a.back() * 1e-3;
  const double past_muscle = end / needle.muscle, short_of_liver = needle.liver / (course.deepest * 1e-3);
  return std::min(past_muscle, short_of_liver) - 1.0;
}

double liver_margin(const Needle& needle, const Course& course) {
  const LayerPuncture& liver = needle.tissue.back().surface;
  return course.deepest * 1e-3 / (needle.liver + liver.deflection) - 1.0;
}

void add_rows(PaperFigure& figure, const Needle& needle, const Course& gap, const Course& liver) {
  figure.rows = {
      number_row({"13", "gap: RMSE over settled windows", "mm"}, 0.051, rmse_settled(gap),
                 settled_note(gap, {kGapTarget})),
      number_row({"13", "liver: RMSE over settled windows", "mm"}, 0.067, rmse_settled(liver),
                 settled_note(liver, {kLiverFirst, kLiverTarget - kLiverFirst})),
      shown_row({"13", "gap: RMSE over everything", "mm"}, 0.051, rmse(gap), "the other reading"),
      shown_row({"13", "liver: RMSE over everything", "mm"}, 0.067, rmse(liver), "the other reading"),
      trend_row("13", "gap: through the muscle, not into the liver", gap_margin(needle, gap),
                fmt::format("deepest {:.2f} mm, liver from {:.1f} mm", gap.deepest, needle.liver * 1e3)),
      trend_row("13", "liver: punctured", liver_margin(needle, liver),
                fmt::format("deepest {:.2f} mm; the liver is punctured at {:.2f} mm", liver.deepest,
                            (needle.liver + needle.tissue.back().surface.deflection) * 1e3)),
  };
}

}  // namespace

PaperFigure figure_13(const PaperModel& model) {
  assert(!model.needle.tissue.empty());
  const PlantModel stage = with_needle(model);
  const Course gap =
      follow(stage, {.target = [](double) { return kGapTarget; }, .seconds = kHold, .loads = {}},
             paper_loop(model.loop_period));
  const Course liver = follow(stage,
                              {.target = stair_target({0.0, kHold}, {kLiverFirst, kLiverTarget}),
                               .seconds = 2.0 * kHold,
                               .loads = {}},
                              paper_loop(model.loop_period));
  PaperFigure figure{"13",
                     "Needle: the gap at 2.5 mm, the liver at 2 and then 3.5 mm",
                     "The needle's depth beside its targets: muscle, gap and liver lie below one another.",
                     {},
                     {}};
  figure.panels = {displacement_panel("gap", gap, {0.0, kHold}),
                   displacement_panel("liver", liver, {0.0, 2.0 * kHold})};
  add_rows(figure, model.needle, gap, liver);
  add_window_rows(figure.rows, "13", "gap: ", 0.051, gap);
  add_window_rows(figure.rows, "13", "liver: ", 0.067, liver);
  return figure;
}

}  // namespace biopsy::sim::paper
