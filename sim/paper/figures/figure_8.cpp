// Fig. 8: what reaches the load through the series spring and through a rigid pole, and the hysteresis of the
// whole stage.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "robot/common/statistics.hpp"
#include "sim/paper/figures/figures.hpp"
#include "sim/paper/figures/rows.hpp"
#include "sim/paper/figures/series_spring.hpp"
#include "sim/paper/open_loop.hpp"
#include "sim/paper/stack_height.hpp"

namespace biopsy::sim::paper {
namespace {

constexpr double kFrequency = 2.0;       // Hz
constexpr double kVisible = 0.01;        // share of the level: the width of a printed line in a panel of 4 cm
constexpr double kSettle = 60.0;         // s, as in Fig. 7b: the transient of the leakage is not an impulse
constexpr double kPrintedSpring = 14.0;  // N/m, IV.C

OpenLoopRun driven(const PaperModel& paper, PlantModel stage, double weight) {
  stage.weight = weight;
  return run_open_loop(
      stage,
      {.amplitude = 6000.0,
       .frequency = kFrequency,
       .settle = kSettle,
       .watch = paper.brief ? 1.0 : 5.0,
       .period = 2.5e-3},
      false);  // with friction the plate approaches its level slowly; the ripple is judged there
}

// Peak to peak in shares of the level.
double ripple(const OpenLoopRun& run) {
  return peak_to_peak(run.displacement) / mean(run.displacement);
}

FigureCurve course(std::string name, const OpenLoopRun& run) {
  FigureCurve curve{std::move(name), {}, run.displacement, false, false};
  for (const double t : run.time) curve.x.push_back(t - run.time.front());
  return curve;
}

void add_load(const PaperModel& paper, double weight, PaperFigure& out) {
  PlantModel stage = paper.stage;
  const OpenLoopRun spring = driven(paper, stage, weight),
                    pole = driven(paper, with_rigid_pole(stage), weight);
  const double soft = ripple(spring), hard = ripple(pole);
  const std::string load = fmt::format("{:.0f} g", 1e3 * weight);
  FigurePanel panel{"2 Hz, 6 kV, " + load, "time (s)", "displacement (mm)", 0.0, 5.0, 0.0, 1.0, false, {}};
  panel.curves = {course("spring", spring), course("rigid pole", pole)};
  for (const OpenLoopRun* run : {&spring, &pole})
    panel.y_high =
        std::max(panel.y_high, 1.15 * *std::max_element(run->displacement.begin(), run->displacement.end()));
  out.panels.push_back(std::move(panel));
  std::string sizes =
      fmt::format("peak to peak {:.2g} % of the level with the spring, {:.2g} % with the pole; visible: 1 %",
                  100.0 * soft, 100.0 * hard);
  if (const double friction = guide_friction(paper.stage); friction > 0.0 && hard < kVisible)
    sizes += fmt::format(
        ". The guide's friction ({:.3f} N, required by Fig. 8b) holds the plate against smaller changes of "
        "the "
        "lift",
        friction);
  out.rows.push_back(
      trend_row("8a", load + ": no visible impulse with the spring", 1.0 - soft / kVisible, sizes));
  out.rows.push_back(
      trend_row("8a", load + ": visible impulses with the rigid pole", hard / kVisible - 1.0, sizes));
}

constexpr double kStep = 500.0;  // V
constexpr int kSteps = 16;       // to 8 kV
constexpr double kHold = 2.0;    // s at each voltage

// Strain in %, by the voltage's level, on the way up and on the way down.
struct Loop {
  std::array<double, kSteps + 1> up{}, down{};

  double largest() const { return *std::max_element(up.begin(), up.end()); }
  std::size_t widest() const {
    std::size_t at = 0;
    for (std::size_t i = 0; i < up.size(); ++i)
      if (down[i] - up[i] > down[at] - up[at]) at = i;
    return at;
  }
  double width() const { return down[widest()] - up[widest()]; }
  double ratio() const { return 100.0 * width() / largest(); }
};

// Holds a voltage and takes the mean of its last drive period. %
double strain_at(const PlantModel& stage, PlantState& state, double voltage) {
  constexpr double kPeriod = 5e-3;
  const int rows = static_cast<int>(kHold / kPeriod);
  const int averaged = static_cast<int>(1.0 / (kFrequency * kPeriod));
  double sum = 0.0;
  for (int i = 0; i < rows; ++i) {
    state = step(stage, state, {.voltage = voltage * polarity_at(i * kPeriod, kFrequency)}, Seconds(kPeriod));
    if (i >= rows - averaged) sum += displacement_reading(stage, state);
  }
  return 100.0 * sum / averaged / stack_height(stage.baseline.n);
}

Loop staircase(PlantModel stage, double weight) {
  stage.weight = weight;
  stage.effects.sensor_noise.reset();
  PlantState state = at_rest(stage);
  Loop loop;
  for (std::size_t i = 0; i <= kSteps; ++i)
    loop.up[i] = strain_at(stage, state, kStep * static_cast<double>(i));
  loop.down[kSteps] = loop.up[kSteps];
  for (std::size_t i = kSteps; i-- > 0;)
    loop.down[i] = strain_at(stage, state, kStep * static_cast<double>(i));
  return loop;
}

constexpr std::array kLoads_g{60, 160, 260};

FigureCurve loop_curve(int load_g, const Loop& loop) {
  FigureCurve curve{fmt::format("{} g", load_g), {}, {}, false, false};
  for (std::size_t i = 0; i < loop.up.size(); ++i) {
    curve.x.push_back(1e-3 * kStep * static_cast<double>(i));
    curve.y.push_back(loop.up[i]);
  }
  for (std::size_t i = loop.down.size(); i-- > 0;) {
    curve.x.push_back(1e-3 * kStep * static_cast<double>(i));
    curve.y.push_back(loop.down[i]);
  }
  return curve;
}

template <class Size>
std::string sizes(const std::array<Loop, 3>& loops, Size&& size) {
  return fmt::format("{:.3g}, {:.3g} and {:.3g} %", size(loops[0]), size(loops[1]), size(loops[2]));
}

void add_loop_rows(const PlantModel& stage, const std::array<Loop, 3>& loops, PaperFigure& out) {
  const std::string height = "of a stack 16.5 mm high: 11 pouches of 1.5 mm, by their oil and their films";
  out.rows = {
      number_row({"8b", "60 g: largest strain (MOS)", "%"}, 50.0, loops[0].largest(), height),
      number_row({"8b", "60 g: largest hysteresis (MHS)", "%"}, 15.0, loops[0].width(), height),
      number_row({"8b", "60 g: voltage of the largest hysteresis", "kV"}, 3.0,
                 1e-3 * kStep * static_cast<double>(loops[0].widest()), "the staircase has steps of 0.5 kV")};
  for (std::size_t i = 0; i < loops.size(); ++i)
    out.rows.push_back(
        number_row({"8b", fmt::format("{} g: ratio of MHS to MOS", kLoads_g[i]), "%"}, 30.0, loops[i].ratio(),
                   fmt::format("{:.3g} of {:.3g} %{}", loops[i].width(), loops[i].largest(),
                               guide_friction(stage) > 0.0
                                   ? "; with the guide's friction, both ways, over the stack's stiffness"
                                   : "")));
  const auto falls = [&](auto&& size) {
    return std::min(size(loops[0]) / size(loops[1]), size(loops[1]) / size(loops[2])) - 1.0;
  };
  out.rows.push_back(trend_row("8b", "MOS falls with the load",
                               falls([](const Loop& l) { return l.largest(); }),
                               sizes(loops, [](const Loop& l) { return l.largest(); })));
  out.rows.push_back(trend_row("8b", "the hysteresis falls with the load",
                               falls([](const Loop& l) { return l.width(); }),
                               sizes(loops, [](const Loop& l) { return l.width(); })));
}

}  // namespace

PaperFigure figure_8a(const PaperModel& paper) {
  PaperFigure out{"8a",
                  "Series spring against rigid pole: 2 Hz, 6 kV, 20 and 100 g",
                  "What the load feels of the reversals, through a spring and through a rigid pole; and when "
                  "a spring filters.",
                  {},
                  {}};
  add_load(paper, 0.020, out);
  add_load(paper, 0.100, out);
  const Baseline& b = paper.stage.baseline;
  const double weight = 0.050 * b.g;
  out.rows.push_back(
      number_row({"8a", std::string(kSpringQuantity), "N/m"}, kPrintedSpring, b.k,
                 "taken for a slip of units: 0.14 N/mm is 140 N/m. With 14 N/m a weight of 50 g alone "
                 "would compress the spring by 35 mm, more than twice the height of the stack, and Fig. 11 "
                 "(50 g put on: 4 mm lost, back within 1 s) would not be possible"));
  if (!paper.brief) add_series_spring(paper, out);
  out.rows.push_back(
      shown_row({"8a", "sag of the spring under 50 g: with the printed 14 N/m, and here", "mm"},
                1e3 * weight / kPrintedSpring, 1e3 * weight / b.k, ""));
  return out;
}

PaperFigure figure_8b(const PaperModel& paper) {
  std::array<Loop, 3> loops;
  PaperFigure out{"8b",
                  "Hysteresis: strain against the amplitude of a 2 Hz square wave, 0 to 8 kV and back",
                  "Up and down again in steps of half a kilovolt, with three loads.",
                  {},
                  {}};
  FigurePanel panel{"60, 160 and 260 g", "voltage (kV)", "strain (%)", 0.0, 8.0, 0.0, 60.0, false, {}};
  for (std::size_t i = 0; i < loops.size(); ++i) {
    const double plates = paper.stage.baseline.fixture_mass + paper.stage.baseline.m_B;
    loops[i] = staircase(paper.stage, std::max(0.0, 1e-3 * kLoads_g[i] - plates));
    panel.curves.push_back(loop_curve(kLoads_g[i], loops[i]));
    panel.y_high = std::max(panel.y_high, 1.1 * loops[i].largest());
  }
  out.panels = {panel};
  add_loop_rows(paper.stage, loops, out);
  return out;
}

}  // namespace biopsy::sim::paper
