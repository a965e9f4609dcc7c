// Fig. 6: three materials under 6 kV DC, three stacked pouches each; how much of the displacement is lost.
#include <fmt/format.h>

#include <algorithm>

#include "sim/paper/figures/figures.hpp"
#include "sim/paper/figures/rows.hpp"
#include "sim/paper/open_loop.hpp"

namespace biopsy::sim::paper {
namespace {

constexpr double kVoltage = 6000.0;  // V
constexpr double kPouches = 3.0;
constexpr double kWeight = 0.020;  // kg on a slider of 30 g: IV.A names it for the first experiment
constexpr double kLeap = 0.5;      // s: "leaped up rapidly"

struct Decay {
  OpenLoopRun run;
  double peak_time = 0.0;  // s
  double loss = 0.0;       // %, of the peak, at the given time
  double early = 0.0;      // share of the peak reached after kLeap
};

Decay decay(const PlantModel& stage, double seconds, double at_time) {
  Decay out;
  out.run = run_open_loop(plate_on_stack(stage, kPouches, kWeight),
                          {.amplitude = kVoltage, .watch = seconds, .period = 10e-3}, false);
  const std::vector<double>& mm = out.run.displacement;
  const auto peak = std::max_element(mm.begin(), mm.end());
  const auto at = [&](double t) { return mm[static_cast<std::size_t>(t / 10e-3) - 1]; };
  out.peak_time = out.run.time[static_cast<std::size_t>(peak - mm.begin())];
  out.loss = 100.0 * (1.0 - at(at_time) / *peak);
  const double highest_soon = *std::max_element(mm.begin(), mm.begin() + static_cast<long>(kLeap / 10e-3));
  out.early = highest_soon / *peak;
  return out;
}

PaperRow loss_row(const char* material, double seconds, double paper, double ours) {
  return number_row(
      {"6", fmt::format("{}: displacement lost in {:g} s of 6 kV DC", material, seconds), "%"}, paper, ours,
      "from the peak; with 20 g on a slider of 30 g. The films differ in tau, K, retained charge, "
      "and in thickness and permittivity as the paper prints them; the guide's friction is "
      "the same for all");
}

}  // namespace

PaperFigure figure_6(const PaperModel& paper) {
  const double long_run = 80.0, short_run = paper.brief ? 10.0 : 80.0;
  const Decay pi25 = decay(with_film(paper.stage, paper.pi25), long_run, 80.0);
  const Decay bopp = decay(with_film(paper.stage, paper.bopp25), short_run, 10.0);
  const Decay pi50 = decay(paper.stage, short_run, 10.0);
  PaperFigure out{"6",
                  "Displacement under 6 kV DC: three stacked pouches of three materials",
                  "Every material lets the displacement fall under DC; which one decides how fast.",
                  {},
                  {}};
  out.panels = {{"6 kV DC", "time (s)", "displacement (mm)", 0.0, 80.0, 0.0, 4.0, false, {}}};
  out.panels[0].curves = {{"25 um PI", pi25.run.time, pi25.run.displacement, false, false},
                          {"25 um pre-coated BOPP", bopp.run.time, bopp.run.displacement, false, false},
                          {"50 um PI", pi50.run.time, pi50.run.displacement, false, false}};
  out.panels[0].y_high = 1.1 * *std::max_element(pi25.run.displacement.begin(), pi25.run.displacement.end());
  out.rows = {loss_row("25 um PI", 80.0, 6.5, pi25.loss),
              loss_row("25 um pre-coated BOPP", 10.0, 96.3, bopp.loss),
              loss_row("50 um PI", 10.0, 71.0, pi50.loss),
              trend_row("6", "the displacement leaps up rapidly, then declines (50 um PI)",
                        pi50.early / 0.9 - 1.0, "nine tenths of the peak within half a second"),
              trend_row("6", "50 um PI loses less than BOPP in the same time", bopp.loss / pi50.loss - 1.0,
                        fmt::format("{:.1f} % against {:.1f} % in 10 s", pi50.loss, bopp.loss)),
              trend_row("6", "25 um PI stays nearly stable: loses less in 80 s than 50 um PI in 10 s",
                        pi50.loss / std::max(1e-3, pi25.loss) - 1.0,
                        fmt::format("{:.1f} % against {:.1f} %", pi25.loss, pi50.loss))};
  return out;
}

}  // namespace biopsy::sim::paper
