// Fig. 12: rotary joint, a link-slider mechanism on plate A; 0 to 8 mm and back in steps of 2 mm, IV.F.1.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/effects/effect_list.hpp"
#include "sim/paper/figures/figures.hpp"
#include "sim/paper/figures/loop_panels.hpp"
#include "sim/paper/figures/loop_scores.hpp"
#include "sim/paper/figures/rows.hpp"
#include "sim/paper/open_loop.hpp"

namespace biopsy::sim::paper {
namespace {

constexpr double kHold = 6.5;         // s on each level: seven of them, and the target is 0 again at 50 s
constexpr double kFirst = 4.5;        // s
constexpr double kDown = 50.0;        // s, "after the 50s", IV.F.1
constexpr double kEnd = 60.0;         // s
constexpr double kAtZero = 0.1;       // mm: tolerance for having returned
constexpr double kNoVoltage = 0.1;    // kV
constexpr double kJointSlips = 2e-3;  // m/s, where its breakaway friction has fallen to 1/e

PlantModel jointed(const PaperModel& model) {
  PlantModel stage = model.stage;
  stage.weight = model.joint.mass;
  CoulombFriction friction;
  if (stage.effects.coulomb_friction) friction = *stage.effects.coulomb_friction;
  friction.force += model.joint.friction;
  if (model.joint.breakaway > 1.0 && !stage.effects.stribeck_friction)
    stage.effects.stribeck_friction =
        StribeckFriction{model.joint.friction, model.joint.breakaway * model.joint.friction, kJointSlips};
  else
    stage.effects.coulomb_friction = friction;
  return stage;
}

OfTime manual_steps() {
  std::vector<double> starts, levels{2.0, 4.0, 6.0, 8.0, 6.0, 4.0, 2.0, 0.0};
  for (std::size_t i = 0; i < levels.size(); ++i) starts.push_back(kFirst + kHold * static_cast<double>(i));
  return stair_target(std::move(starts), std::move(levels));
}

// Degrees that the crank has turned at displacement x (m): the pin is lifted by crank (sin(start + turn) -
// sin(start)).
double turn_degrees(const Joint& joint, double x) {
  const double height = std::clamp(std::sin(joint.start) + x / joint.crank, -1.0, 1.0);
  return (std::asin(height) - joint.start) * 180.0 / std::numbers::pi;
}

// The paper suggests plastic deformation of the pouches; a single run cannot separate that from friction.
std::string held_note(const PlantModel& stage, double left, double kilovolts) {
  std::string note = fmt::format("{:.3f} kV", kilovolts);
  if (kilovolts >= kNoVoltage || left <= kAtZero) return note;
  const bool set = stage.effects.residual_set && stage.effects.residual_set->floor_share > 0.0;
  if (guide_friction(stage) > 0.0)
    note += fmt::format(
        ": friction of the guide{} holds plate A up. The paper suggests slight plastic deformation of the "
        "pouches",
        set ? " and the pouches' residual set" : ", without residual set,");
  return note;
}

constexpr double kSharp = 0.5;  // s, the longest that a peak is above half of its height
constexpr double kSeen =
    8.0 * 2.0 * kLineShare;        // mm, a line's width where 8 mm fill half of a panel's width
constexpr std::size_t kMean = 20;  // ticks over which readings are averaged against the laser's noise

struct Peak {
  double height = 0.0, time = 0.0;  // mm, s
};

// The highest peak over every target of the last kSettling, so that a falling edge is none.
Peak sharpest_peak(const Course& course) {
  const auto back = static_cast<std::size_t>(std::lround(kSettling / 1e-3));
  std::vector<double> above;
  for (std::size_t k = 0; k + kMean <= course.time.size(); k += kMean) {
    const auto end = course.target.begin() + static_cast<std::ptrdiff_t>(k + kMean);
    const double highest =
        *std::max_element(end - static_cast<std::ptrdiff_t>(std::min(back, k + kMean)), end);
    above.push_back(mean_between(course, course.plate_a, course.time[k], course.time[k] + 1e-3 * kMean) -
                    highest);
  }
  Peak highest;
  for (std::size_t i = 1; i + 1 < above.size(); ++i) {
    if (above[i] <= highest.height) continue;
    std::size_t first = i, last = i;
    while (first > 0 && above[first - 1] > 0.5 * above[i]) --first;
    while (last + 1 < above.size() && above[last + 1] > 0.5 * above[i]) ++last;
    if (1e-3 * static_cast<double>((last - first + 1) * kMean) <= kSharp)
      highest = {above[i], course.time[i * kMean]};
  }
  return highest;
}

void add_rows(PaperFigure& figure, const PlantModel& stage, const Course& course) {
  const Peak peak = sharpest_peak(course);
  const double left = mean_between(course, course.plate_a, kEnd - 1.0, kEnd);
  const double volts = mean_between(course, course.amplitude, kEnd - 1.0, kEnd);
  figure.rows = {
      number_row(
          {"12", "RMSE over everything", "mm"}, 0.386, rmse(course),
          fmt::format(
              "over everything: the paper describes the whole manipulation, and eight steps of 2 mm that "
              "decay "
              "with a time constant tau add sqrt(16 mm^2 tau / {:.0f} s). Settled windows alone give {:.3f} "
              "mm: "
              "the {:.2f} mm left at the end contribute to both, and the text does not say which one it is",
              kEnd, rmse_settled(course), left)),
      shown_row({"12", "RMSE over settled windows", "mm"}, 0.386, rmse_settled(course),
                "the other reading of the row above"),
      trend_row("12", "some sharp peaks in the displacement", peak.height / kSeen - 1.0,
                fmt::format(
                    "the highest rises {:.2f} mm above the target, at {:.1f} s, and is back at half of that "
                    "within {:g} s; a reader sees {:.2f} mm",
                    peak.height, peak.time, kSharp, kSeen)),
      trend_row(
          "12", "does not return to 0 after 50 s", left / kAtZero - 1.0,
          fmt::format(
              "{:.2f} mm are left {:.0f} s after the target went to 0; {:.1f} mm would count as returned",
              left, kEnd - kDown, kAtZero)),
      trend_row("12", "the voltage is 0 V by then", 1.0 - volts / kNoVoltage, held_note(stage, left, volts)),
  };
}

}  // namespace

PaperFigure figure_12(const PaperModel& model) {
  const Course course = follow(jointed(model), {.target = manual_steps(), .seconds = kEnd, .loads = {}},
                               paper_loop(model.loop_period));
  PaperFigure figure{"12",
                     "Rotary joint: 0 to 8 mm and back in steps of 2 mm",
                     "Eight steps by hand, up and down again, and ten seconds at 0.",
                     {},
                     {}};
  const TimeSpan all{0.0, kEnd};
  FigurePanel turned = displacement_panel("rotation", course, all);
  turned.y_title = "rotation (degrees)";
  for (FigureCurve& curve : turned.curves)
    for (double& y : curve.y) y = turn_degrees(model.joint, y * 1e-3);
  fit_height(turned);
  figure.panels = {displacement_panel("displacement", course, all), turned,
                   voltage_panel("applied voltage", course, all)};
  add_rows(figure, model.stage, course);
  add_window_rows(figure.rows, "12", "", 0.386, course);
  return figure;
}

}  // namespace biopsy::sim::paper
