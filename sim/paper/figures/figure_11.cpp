// Fig. 11: 50 g put on plate A at 5 mm, and taken off again, IV.E.
#include <fmt/format.h>

#include <cmath>

#include "sim/paper/figures/figures.hpp"
#include "sim/paper/figures/loop_panels.hpp"
#include "sim/paper/figures/loop_scores.hpp"
#include "sim/paper/figures/rows.hpp"
#include "sim/paper/paper_targets.hpp"

namespace biopsy::sim::paper {
namespace {

constexpr double kHeld = 5.0;             // mm
constexpr double kOn = 5.0, kOff = 10.0;  // s
constexpr double kEnd = 15.0;             // s
constexpr double kImpact = 0.050;         // kg
constexpr double kBack = 0.1;             // of the target: tolerance for having returned

// From `start` until the last time before `end` that plate A is further off than kBack. s
double recovery(const Course& course, double start, double end) {
  double last = start;
  for (std::size_t k = 0; k < course.time.size(); ++k)
    if (course.time[k] >= start && course.time[k] < end &&
        std::abs(course.plate_a[k] - kHeld) > kBack * kHeld)
      last = course.time[k];
  return last - start;
}

// Statics of the fall: the spring alone, with the stack at constant height.
std::string fall_note(const PlantModel& stage, double lowest) {
  const double sag = kImpact * stage.baseline.g / stage.baseline.k * 1e3;
  return fmt::format(
      "falls by {:.2f} mm. 50 g on {:.0f} N/m sag {:.2f} mm at rest, and up to twice that dynamically; the "
      "paper's 14 N/m would give 35 mm, three times the stroke",
      kHeld - lowest, stage.baseline.k, sag);
}

void add_rows(PaperFigure& figure, const PlantModel& stage, const Course& course) {
  const double lowest = span(course, course.plate_a, kOn, kOff).low;
  const double highest = span(course, course.plate_a, kOff, kEnd).high;
  const double on = recovery(course, kOn, kOff), off = recovery(course, kOff, kEnd);
  figure.rows = {
      number_row({"11", "lowest displacement after 50 g are put on", "mm"}, 1.0, lowest,
                 fall_note(stage, lowest)),
      number_row(
          {"11", "back at 5 mm after 50 g are put on", "s"}, 1.0, on,
          fmt::format("until plate A stays within 10 % of the target{}",
                      on > 0.99 * (kOff - kOn) ? ", which it does not before they are taken off" : "")),
      number_row({"11", "highest displacement after 50 g are taken off", "mm"}, 11.0, highest,
                 fmt::format("rises by {:.2f} mm from the target: spring and lighter stack together",
                             highest - kHeld)),
      trend_row("11", "back quickly after 50 g are taken off", 1.0 / std::max(off, 1e-3) - 1.0,
                fmt::format(
                    "{:.2f} s until plate A stays within 10 % of the target; quickly: no slower than the 1 s "
                    "of putting on",
                    off)),
  };
}

}  // namespace

PaperFigure figure_11(const PaperModel& model) {
  PlantModel stage = model.stage;
  stage.weight = kWeight;
  const Course course = follow(stage,
                               {.target = [](double) { return kHeld; },
                                .seconds = kEnd,
                                .loads = {{.from = kOn,
                                           .to = kOff,
                                           .mass = kImpact,
                                           .speed = std::sqrt(2.0 * stage.baseline.g * model.drop)}}},
                               paper_loop(model.loop_period));
  PaperFigure figure{"11",
                     "Impact: 50 g put on plate A at 5 mm, and taken off",
                     "The spring yields at once, then the loop returns plate A to its target.",
                     {},
                     {}};
  figure.panels = {displacement_panel("displacement", course, {2.0, kEnd}),
                   voltage_panel("applied voltage", course, {2.0, kEnd})};
  add_rows(figure, stage, course);
  return figure;
}

}  // namespace biopsy::sim::paper
