// Fig. 9c,d: square waves and sines of 0.1, 0.2 and 0.5 Hz at 50 g, IV.D.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/paper/figures/figures.hpp"
#include "sim/paper/figures/loop_panels.hpp"
#include "sim/paper/figures/loop_scores.hpp"
#include "sim/paper/figures/rows.hpp"
#include "sim/paper/paper_targets.hpp"

namespace biopsy::sim::paper {
namespace {

constexpr std::array kFrequencies{0.1, 0.2, 0.5};  // Hz
constexpr double kPeriods = 3.0;                   // the first one starts from rest and is left out
constexpr double kLossless = 0.95;  // of the target's travel: no visible loss in the paper's figure
constexpr double kInPhase = 18.0;   // degrees, a twentieth of a period: no visible lag

struct Followed {
  double frequency = 0.0;
  Course course;
  double first = 0.0;  // s, where the first whole period after the start begins
};

std::vector<Followed> follow_all(const PaperModel& model, OfTime (*target)(double, double, double),
                                 double low, double high) {
  PlantModel stage = model.stage;
  stage.weight = kWeight;
  std::vector<Followed> out;
  out.reserve(kFrequencies.size());
  for (const double f : kFrequencies) {
    out.push_back({f,
                   follow(stage, {.target = target(low, high, f), .seconds = kPeriods / f, .loads = {}},
                          paper_loop(model.loop_period)),
                   1.0 / f});
  }
  return out;
}

// Difference of the plateaus, by the mean over the last fifth of each half period. Share of the target's
// travel.
double plateau_share(const Followed& followed) {
  const Course& c = followed.course;
  const double period = 1.0 / followed.frequency;
  double low = 0.0, high = 0.0, count = 0.0;
  for (double start = followed.first; start + period <= c.time.back() + 0.01; start += period) {
    low += mean_between(c, c.plate_a, start + 0.4 * period, start + 0.5 * period);
    high += mean_between(c, c.plate_a, start + 0.9 * period, start + period);
    count += 1.0;
  }
  return (high - low) / count / (kSquareHigh - kSquareLow);
}

// Larger of plate A's travels up and down from the middle; 1 is the plateau.
double reach(const Followed& followed) {
  const Span span_a =
      span(followed.course, followed.course.plate_a, followed.first, followed.course.time.back());
  const double middle = 0.5 * (kSquareLow + kSquareHigh), half = 0.5 * (kSquareHigh - kSquareLow);
  return std::max(span_a.high - middle, middle - span_a.low) / half;
}

double largest_overshoot(const std::vector<Followed>& all) {
  double most = 0.0;
  for (const Followed& one : all) most = std::max(most, overshoot_percent(one.course));
  return most;
}

// How far plate A goes beyond its targets at most, mm.
struct Beyond {
  double rising = 0.0, falling = 0.0;
};

Beyond largest_beyond(const std::vector<Followed>& all) {
  Beyond most;
  for (const Followed& one : all)
    for (const Edge& edge : edges(one.course)) {
      double& side = edge.rises() ? most.rising : most.falling;
      side = std::max(side, beyond_target(one.course, edge));
    }
  return most;
}

std::string reach_note(const PlantModel& stage, double reached) {
  std::string note = fmt::format(
      "plate A gets {:.1f} % of the way from the middle to the one plateau that it comes furthest towards",
      100.0 * reached);
  if (reached > 1.0)
    note += fmt::format(
        ", and beyond it: after an edge the loop saturates at the amplifier's limit or at 0, so that oil "
        "with a "
        "time constant of {:.2f} s closes the {:.0f} mm before the half period of 1 s is over",
        stage.baseline.tau_h, kSquareHigh - kSquareLow);
  return note;
}

PaperFigure fast_figure(std::string number, std::string title, std::string sentence,
                        const std::vector<Followed>& all) {
  PaperFigure figure{std::move(number), std::move(title), std::move(sentence), {}, {}};
  for (const Followed& one : all)
    figure.panels.push_back(
        displacement_panel(fmt::format("{} Hz", one.frequency), one.course, {0.0, kPeriods / one.frequency}));
  return figure;
}

void add_sine_rows(PaperFigure& figure, const PlantModel& stage, const Followed& one) {
  const Transfer seen = transfer(one.course, one.frequency, one.first);
  const double travel = span(one.course, one.course.plate_a, one.first, one.course.time.back()).width();
  std::string note = fmt::format(
      "fundamental: {:.3f} of the target's, {:.1f} degrees ({:.2f} s) late; peak to peak {:.1f} % of the "
      "target's, including what is missing at 0 (9b). A first-order lag that attenuates by 5 % delays by 18 "
      "degrees",
      seen.gain, seen.lag_degrees, seen.lag_degrees / 360.0 / one.frequency,
      100.0 * travel / (kSineHigh - kSineLow));
  if (seen.lag_degrees > kInPhase)
    note += fmt::format(": the oil's time constant of {:.2f} s causes more phase lag than attenuation",
                        stage.baseline.tau_h);
  const std::string hertz = fmt::format("{} Hz: ", one.frequency);
  const double in_phase = kInPhase / std::max(1e-3, std::abs(seen.lag_degrees)) - 1.0;
  if (one.frequency < 0.3)
    figure.rows.push_back(
        trend_row("9d", hertz + "followed without attenuation", seen.gain / kLossless - 1.0, note));
  else
    figure.rows.push_back(trend_row("9d", hertz + "attenuated", kLossless / seen.gain - 1.0, note));
  figure.rows.push_back(
      trend_row("9d", hertz + "phase kept, within a twentieth of a period", std::min(1.0, in_phase), note));
}

}  // namespace

PaperFigure figure_9c(const PaperModel& model) {
  const std::vector<Followed> all = follow_all(model, square_target, kSquareLow, kSquareHigh);
  PaperFigure figure =
      fast_figure("9c", "Square waves of 0.1, 0.2 and 0.5 Hz, 50 g",
                  "Plate A beside square waves of three frequencies, each from 2 to 8 mm.", all);
  for (const Followed& one : all) {
    if (one.frequency > 0.3) continue;
    const double share = plateau_share(one);
    figure.rows.push_back(
        trend_row("9c", fmt::format("{} Hz: followed without loss", one.frequency), share / kLossless - 1.0,
                  fmt::format("{:.1f} % of the target's travel between the plateaus; {:.0f} % is no visible "
                              "loss; {}",
                              100.0 * share, 100.0 * kLossless, kTargetsNote)));
  }
  figure.rows.push_back(number_row(
      {"9c", "largest overshoot, of the target", "%"}, 13.0, largest_overshoot(all),
      "\"overshooted the target value by 13 %\" (IV.D): over all rising edges of the three waves"));
  const Beyond most = largest_beyond(all);
  figure.rows.push_back(trend_row(
      "9c", "the largest overshoot is that of a falling edge",
      most.falling / std::max(1e-3, most.rising) - 1.0,
      fmt::format(
          "\"occasionally large overshoot at the falling edge\" (IV.D): {:.2f} mm below the target after a "
          "fall, {:.2f} mm above it after a rise",
          most.falling, most.rising)));
  const double reached = reach(all.back());
  figure.rows.push_back(trend_row("9c", "0.5 Hz: neither plateau is reached", kLossless / reached - 1.0,
                                  reach_note(model.stage, reached)));
  const double rise = mean_travel(all.front().course, true), fall = mean_travel(all.front().course, false);
  figure.rows.push_back(
      trend_row("9c", "0.1 Hz: falling edges lag", visible_lag(all.front().course),
                fmt::format("{:.0f} ms up, {:.0f} ms down; a reader sees {:.0f} ms", 1e3 * rise, 1e3 * fall,
                            1e3 * kLineShare * all.front().course.time.back())));
  return figure;
}

PaperFigure figure_9d(const PaperModel& model) {
  const std::vector<Followed> all = follow_all(model, sine_target, kSineLow, kSineHigh);
  PaperFigure figure = fast_figure("9d", "Sines of 0.1, 0.2 and 0.5 Hz, 50 g",
                                   "Plate A beside sines of three frequencies, each from 0 to 8 mm.", all);
  for (const Followed& one : all) add_sine_rows(figure, model.stage, one);
  double beyond = 0.0;  // mm
  for (const Followed& one : all)
    beyond =
        std::max(beyond, span(one.course, one.course.plate_a, 0.0, one.course.time.back()).high - kSineHigh);
  const double sine = 100.0 * beyond / kSineHigh,
               square = largest_overshoot(follow_all(model, square_target, kSquareLow, kSquareHigh));
  figure.rows.push_back(
      trend_row("9d", "sines overshoot less than squares", square / std::max(0.1, sine) - 1.0,
                fmt::format("{:.1f} % of the highest target, squares {:.1f} %", sine, square)));
  return figure;
}

}  // namespace biopsy::sim::paper
