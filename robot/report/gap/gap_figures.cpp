#include "robot/report/gap/gap_figures.hpp"

#include <algorithm>
#include <cmath>

#include "robot/report/gap/gap_labels.hpp"
#include "robot/report/plot/svg_bars.hpp"
#include "robot/report/plot/svg_chart.hpp"

namespace biopsy::report {
namespace {

// Blue and orange-brown stay apart for every common colour blindness and in grey; the old model is dashed
// too.
const Stroke kMeasured{"#1d262e", 1.2, ""};
const Stroke kOldModel{"#b85c00", 1.7, "6 3"};
const Stroke kNewModel{"#005fa8", 1.5, ""};
constexpr const char* kStrongTint = "#f7cf7a";
constexpr const char* kTints[] = {"#dce9f5", "#eceff1", "#dcefe3", "#efe3f0",
                                  "#c9d8e2", "#f3ead9", "#d5dcd6"};

// Low enough that verdict, where and before/after share one printed sheet.
constexpr double kInput_px = 60, kResidual_px = 118, kDisplacement_px = 125;

constexpr int kGapColumns = 375;        // four points each: at most 1500 a line
constexpr std::size_t kManySpans = 25;  // beyond this a shaded run is a blur and gets a closer look
constexpr double kCloser = 0.1;         // share of the run
constexpr std::size_t kRegimesInBars = 5;

using Values = std::vector<double>;

Values residual(const GapTrace& trace, const Values& model) {
  Values difference(std::min(trace.measured.size(), model.size()));
  for (std::size_t i = 0; i < difference.size(); ++i) difference[i] = trace.measured[i] - model[i];
  return difference;
}

double rms(const Values& values) {
  double sum = 0, count = 0;
  for (const double value : values)
    if (std::isfinite(value)) sum += value * value, ++count;
  return count > 0 ? std::sqrt(sum / count) : 0;
}

ChartLine line(const Chart& chart, const Values& time, const Values& values, std::string name,
               const Stroke& stroke) {
  ChartLine drawn{std::move(name), stroke, {}};
  std::vector<Vertex> points;
  for (std::size_t i = 0; i < std::min(time.size(), values.size()); ++i)
    if (time[i] >= chart.x_low && time[i] <= chart.x_high) points.push_back({time[i], values[i]});
  drawn.points = decimated(points, chart.x_low, chart.x_high, kGapColumns);
  return drawn;
}

Chart over_time(const GapTrace& trace) {
  Chart chart;
  chart.x_title = "Time in run " + trace.run + (trace.held_out ? ", held out (s)" : ", used to fit (s)");
  chart.x_low = trace.time.front();
  chart.x_high = std::max(trace.time.back(), chart.x_low + 1e-9);
  return chart;
}

// The two lines between which two thirds of mere noise would stay.
void add_noise_levels(ChartPanel& residual_panel, double noise) {
  if (!(noise > 0)) return;
  residual_panel.y_low = std::min(residual_panel.y_low, -1.5 * noise);
  residual_panel.y_high = std::max(residual_panel.y_high, 1.5 * noise);
  residual_panel.levels = {{-noise, "− noise"}, {noise, "+ noise"}};
}

std::string regime_name(const GapFinding& finding, std::size_t index) {
  return index < finding.regime_names.size() ? regime_label(finding.regime_names[index], finding.force_drive)
                                             : "elsewhere";
}

// The regime of this run that concentrates the error most: the strongest tint is its.
std::string most_affected_regime(const GapFinding& finding, const std::vector<ChartShade>& shades) {
  for (const GapRegime& regime : finding.where)
    for (const ChartShade& shade : shades)
      if (regime.share_of_excess_error > regime.share_of_time &&
          shade.name == regime_label(regime.name, finding.force_drive))
        return shade.name;
  return {};
}

// A point stands for the time until the next one.
std::vector<ChartShade> shades_of(const GapFinding& finding, const GapTrace& trace, const Chart& chart) {
  std::vector<ChartShade> shades;
  const auto shade_named = [&](const std::string& name) -> ChartShade& {
    for (ChartShade& shade : shades)
      if (shade.name == name) return shade;
    return shades.emplace_back(ChartShade{name, "", {}});
  };
  const std::size_t count = std::min(trace.time.size(), trace.regime.size());
  for (std::size_t i = 0, next = 0; i < count; i = next) {
    for (next = i + 1; next < count && trace.regime[next] == trace.regime[i];) ++next;
    const double from = std::max(trace.time[i], chart.x_low);
    const double to = std::min(trace.time[std::min(next, count - 1)], chart.x_high);
    if (to > from) shade_named(regime_name(finding, trace.regime[i])).spans.push_back({from, to});
  }
  const std::string affected = most_affected_regime(finding, shades);
  std::size_t next_tint = 0;
  for (ChartShade& shade : shades)
    shade.colour = shade.name == affected ? kStrongTint : kTints[next_tint++ % std::size(kTints)];
  return shades;
}

Chart where_chart(const GapFinding& finding, const GapTrace& trace, const ChartSpan& span) {
  Chart chart = over_time(trace);
  chart.x_low = span.x_from;
  chart.x_high = span.x_to;
  const bool force = finding.force_drive;
  chart.panels = {autoscaled_panel(force ? "Force (N)" : "Input (kV)", kInput_px,
                                   {line(chart, trace.time, trace.input, "", kMeasured)}),
                  autoscaled_panel("Residual (mm)", kResidual_px,
                                   {line(chart, trace.time, residual(trace, trace.before),
                                         "measured − old model", kMeasured)})};
  add_noise_levels(chart.panels[1], finding.noise_floor);
  chart.shades = shades_of(finding, trace, chart);
  return chart;
}

// The stretch of the given length with the largest sum of squared residuals.
ChartSpan worst_stretch(const GapTrace& trace, double length) {
  const Values gap = residual(trace, trace.before);
  ChartSpan worst{trace.time.front(), trace.time.front() + length};
  double sum = 0, largest = 0;
  std::size_t first = 0;
  for (std::size_t i = 0; i < std::min(gap.size(), trace.time.size()); ++i) {
    if (std::isfinite(gap[i])) sum += gap[i] * gap[i];
    for (; trace.time[i] - trace.time[first] > length; ++first)
      if (std::isfinite(gap[first])) sum -= gap[first] * gap[first];
    if (sum <= largest) continue;
    largest = sum;
    worst = {trace.time[first], trace.time[first] + length};
  }
  return worst;
}

bool drawable(const GapTrace& trace) {
  return trace.time.size() > 1 && trace.measured.size() == trace.time.size() &&
         trace.before.size() == trace.time.size();
}

template <class Eligible>
const GapTrace* largest_gap_among(const GapFinding& finding, Eligible eligible) {
  const GapTrace* found = nullptr;
  double largest = -1;
  for (const GapTrace& trace : finding.traces) {
    if (!drawable(trace) || !eligible(trace)) continue;
    const double gap = rms(residual(trace, trace.before));
    if (gap <= largest) continue;
    largest = gap;
    found = &trace;
  }
  return found;
}

}  // namespace

const GapTrace* largest_gap_trace(const GapFinding& finding) {
  return largest_gap_among(finding, [](const GapTrace&) { return true; });
}

const GapTrace* overlay_trace(const GapFinding& finding) {
  const GapTrace* held_out = largest_gap_among(finding, [](const GapTrace& trace) { return trace.held_out; });
  return held_out ? held_out : largest_gap_trace(finding);
}

bool model_changed(const GapTrace& trace) {
  return trace.after.size() == trace.time.size() && trace.after != trace.before;
}

std::string where_figure(const GapFinding& finding) {
  const GapTrace* trace = largest_gap_trace(finding);
  if (!trace) return {};
  Chart chart = where_chart(finding, *trace, {trace->time.front(), trace->time.back()});
  chart.title = "Where the old model disagrees, over a whole run";
  chart.description =
      "Above: the input. Below: measured minus old model. The background names the situation at each moment.";
  return render(chart);
}

std::string where_closer_figure(const GapFinding& finding) {
  const GapTrace* trace = largest_gap_trace(finding);
  if (!trace) return {};
  std::size_t spans = 0;
  for (std::size_t i = 1; i < trace->regime.size(); ++i) spans += trace->regime[i] != trace->regime[i - 1];
  if (spans < kManySpans) return {};
  const double length = kCloser * (trace->time.back() - trace->time.front());
  Chart chart = where_chart(finding, *trace, worst_stretch(*trace, length));
  chart.title = "The tenth of the run in which the old model disagrees most";
  chart.description = "As the figure above, closer.";
  return render(chart);
}

std::string shares_figure(const GapFinding& finding) {
  if (finding.where.empty()) return {};
  BarChart chart;
  chart.title = "Share of time and share of the excess error";
  chart.description = "For each situation, how much of the time it holds and how much of the excess error.";
  chart.x_title = "Share of all runs together (%)";
  chart.unit = "%";
  chart.series = {{"share of time", "#9aa5ae"}, {"share of excess error", "#005fa8"}};
  for (const GapRegime& regime : finding.where) {
    if (chart.rows.size() == kRegimesInBars) break;
    chart.rows.push_back({regime_label(regime.name, finding.force_drive),
                          {100 * regime.share_of_time, 100 * regime.share_of_excess_error}});
  }
  return render(chart);
}

std::string overlay_figure(const GapFinding& finding) {
  const GapTrace* trace = overlay_trace(finding);
  if (!trace) return {};
  Chart chart = over_time(*trace);
  chart.title = "Measurement and model";
  chart.description =
      "Above: displacement. Below: measured minus model. Old and new model where they differ.";
  const Values &time = trace->time, before = residual(*trace, trace->before);
  const bool changed = model_changed(*trace);
  const std::string old_name = changed ? "old model" : "model";
  const Stroke& old_stroke = changed ? kOldModel : kNewModel;
  std::vector<ChartLine> displacement{line(chart, time, trace->measured, "measured", {"#8b959d", 3.2, ""}),
                                      line(chart, time, trace->before, old_name, old_stroke)};
  std::vector<ChartLine> gaps{line(chart, time, before, "measured − " + old_name, old_stroke)};
  if (changed) {
    displacement.push_back(line(chart, time, trace->after, "new model", kNewModel));
    gaps.push_back(line(chart, time, residual(*trace, trace->after), "measured − new model", kNewModel));
  }
  chart.panels = {autoscaled_panel("Displacement (mm)", kDisplacement_px, std::move(displacement)),
                  autoscaled_panel("Residual (mm)", kResidual_px, std::move(gaps))};
  add_noise_levels(chart.panels[1], finding.noise_floor);
  return render(chart);
}

std::string shape_figure(const ResidualShape& shape) {
  if (shape.at.size() < 2 || shape.mean.size() != shape.at.size()) return {};
  const std::string quantity = readable_name(shape.quantity);
  Chart chart;
  chart.title = "Mean residual against " + quantity;
  chart.description = "Measured minus model, averaged over all moments with the same " + quantity + ".";
  chart.x_title = quantity + (shape.unit.empty() ? "" : " (" + shape.unit + ")");
  chart.note = percent_text(shape.share_explained) + " of the residual's variance";
  chart.x_low = shape.at.front();
  chart.x_high = std::max(shape.at.back(), chart.x_low + 1e-12);
  chart.panels = {autoscaled_panel(
      "Mean (mm)", 150, {line(chart, shape.at, shape.mean, "mean of measured − model", kNewModel)})};
  chart.panels[0].levels = {{0, "0"}};
  if (shape.count.size() == shape.at.size()) {
    chart.panels.push_back(autoscaled_panel(
        "Count", 60, {line(chart, shape.at, shape.count, "measurements behind each mean", kMeasured)}));
    chart.panels.back().y_low = 0;
  }
  return render(chart);
}

}  // namespace biopsy::report
