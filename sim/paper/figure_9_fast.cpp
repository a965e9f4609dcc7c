// Fig. 9c,d: square waves and sines of 0.1, 0.2 and 0.5 Hz at 50 g, IV.D.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/paper/figures.hpp"
#include "sim/paper/loop_panels.hpp"
#include "sim/paper/loop_scores.hpp"
#include "sim/paper/paper_targets.hpp"
#include "sim/paper/rows.hpp"

namespace biopsy::sim::paper {
namespace {

constexpr std::array kFrequencies{0.1, 0.2, 0.5};  // Hz
constexpr double kPeriods = 3.0;    // the first one starts from rest and is not judged for loss
constexpr double kLossless = 0.95;  // of the target's travel: an eye on the paper's figure sees no loss
constexpr double kInPhase = 18.0;   // degrees, a twentieth of a period: the same eye sees no lag

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
    out.push_back(
        {f,
         follow(stage, {.target = target(low, high, f), .seconds = kPeriods / f, .loads = {}}, paper_loop()),
         1.0 / f});
  }
  return out;
}

// Mean over the last fifth of each half period: where the plateau should stand. Share of the target's travel.
double plateau_share(const Followed& followed) {
  const Course& c = followed.course;
  const double period = 1.0 / followed.frequency;
  double low = 0.0, high = 0.0, count = 0.0;
  for (double start = followed.first; start + period <= c.time.back() + 0.01; start += period) {
    low += mean(c, c.plate_a, start + 0.4 * period, start + 0.5 * period);
    high += mean(c, c.plate_a, start + 0.9 * period, start + period);
    count += 1.0;
  }
  return (high - low) / count / (kSquareHigh - kSquareLow);
}

// How far up and down plate A gets from the middle, the further of both; 1 is the plateau.
double reach(const Followed& followed) {
  const Span span_a =
      span(followed.course, followed.course.plate_a, followed.first, followed.course.time.back());
  const double middle = 0.5 * (kSquareLow + kSquareHigh), half = 0.5 * (kSquareHigh - kSquareLow);
  return std::max(span_a.high - middle, middle - span_a.low) / half;
}

PaperFigure fast_figure(std::string number, std::string title, std::string sentence,
                        const std::vector<Followed>& all) {
  PaperFigure figure;
  figure.number = std::move(number);
  figure.title = std::move(title);
  figure.sentence = std::move(sentence);
  for (const Followed& one : all)
    figure.panels.push_back(
        displacement_panel(fmt::format("{} Hz", one.frequency), one.course, {0.0, one.course.time.back()}));
  return figure;
}

void add_sine_rows(PaperFigure& figure, const Followed& one) {
  const Transfer seen = transfer(one.course, one.frequency, one.first);
  const std::string note = fmt::format(
      "fundamental: {:.3f} of the target's, {:.1f} degrees late; a lag of first order that takes 5 % takes "
      "18 degrees "
      "with it",
      seen.gain, seen.lag_degrees);
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
                  "The slower two reach their plateaus; falling takes longer than rising.", all);
  for (const Followed& one : all) {
    if (one.frequency > 0.3) continue;
    const double share = plateau_share(one);
    figure.rows.push_back(trend_row(
        "9c", fmt::format("{} Hz: followed without loss", one.frequency), share / kLossless - 1.0,
        fmt::format("{:.1f} % of the target's travel between the plateaus; {:.0f} % is no loss that a "
                    "figure shows; {}",
                    100.0 * share, 100.0 * kLossless, kTargetsNote)));
  }
  double most = 0.0;
  for (const Followed& one : all) most = std::max(most, overshoot_percent(one.course));
  figure.rows.push_back(at_most_row({"9c", "largest overshoot, of the target", "%"}, 13.0, most,
                                    "over all rising edges of the three waves"));
  const double reached = reach(all.back());
  figure.rows.push_back(trend_row(
      "9c", "0.5 Hz: neither plateau is reached", kLossless / reached - 1.0,
      fmt::format(
          "plate A gets {:.1f} % of the way from the middle to the plateau that it comes nearest to, and "
          "beyond it: from an edge on the loop asks for all that the amplifier has, so that oil with a time "
          "constant of {:.2f} s has closed the 6 mm before the half period of 1 s is over, and overshoots. A "
          "stage too slow for that would lose 9a and 11",
          100.0 * reached, model.stage.baseline.tau_h)));
  const double rise = mean_travel(all.front().course, true), fall = mean_travel(all.front().course, false);
  figure.rows.push_back(trend_row("9c", "0.1 Hz: falling edges lag", fall / rise - 1.0,
                                  fmt::format("{:.0f} ms up, {:.0f} ms down", 1e3 * rise, 1e3 * fall)));
  return figure;
}

PaperFigure figure_9d(const PaperModel& model) {
  const std::vector<Followed> all = follow_all(model, sine_target, kSineLow, kSineHigh);
  PaperFigure figure = fast_figure("9d", "Sines of 0.1, 0.2 and 0.5 Hz, 50 g",
                                   "The slower two are followed in height and phase.", all);
  for (const Followed& one : all) add_sine_rows(figure, one);
  return figure;
}

}  // namespace biopsy::sim::paper
