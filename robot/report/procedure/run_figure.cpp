#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robot/common/text/number_text.hpp"
#include "robot/report/plot/svg_chart.hpp"
#include "robot/report/procedure/html_sections.hpp"
#include "robot/report/procedure/labels.hpp"

namespace biopsy::report {
namespace {

constexpr double kTick_s = 1e-3;

double seconds(const Sample& sample) {
  return sample.time_ms * 1e-3;
}

template <class Value>
ChartLine line(const RunRecord& record, std::string name, Stroke stroke, Value value) {
  ChartLine drawn{std::move(name), std::move(stroke), {}};
  drawn.points.reserve(record.samples.size());
  for (const Sample& sample : record.samples)
    drawn.points.push_back({seconds(sample), static_cast<double>(value(sample))});
  return drawn;
}

// The stretches of time in which `holds` is true; a sample stands for the tick that follows it.
template <class Holds>
std::vector<ChartSpan> spans(const RunRecord& record, Holds holds) {
  std::vector<ChartSpan> found;
  bool inside = false;
  for (const Sample& sample : record.samples) {
    const bool now = holds(sample);
    if (now && !inside) found.push_back({seconds(sample), seconds(sample)});
    if (now) found.back().x_to = seconds(sample) + kTick_s;
    inside = now;
  }
  return found;
}

template <class Value>
double highest(const RunRecord& record, double at_least, Value value) {
  for (const Sample& sample : record.samples)
    at_least = std::max(at_least, static_cast<double>(value(sample)));
  return at_least;
}

std::vector<ChartLevel> depth_levels(const RunRecord& record) {
  if (!record.plan) return {};
  std::vector<ChartLevel> levels{
      {record.plan->target_depth.value, "target " + fixed(record.plan->target_depth.value, 2)}};
  for (const Layer& layer : record.plan->layers)
    if (layer.from.value > 0 && layer.from <= record.plan->limits.depth_max)
      levels.push_back({layer.from.value, layer.name + " " + fixed(layer.from.value, 2)});
  if (record.plan->limits.depth_max.value > 0)
    levels.push_back(
        {record.plan->limits.depth_max.value, "deepest " + fixed(record.plan->limits.depth_max.value, 2)});
  return levels;
}

std::vector<ChartDot> image_depths(const RunRecord& record) {
  std::vector<ChartDot> dots;
  for (const StepResult& step : record.steps)
    if (step.check && step.check->tip_found && std::isfinite(step.image_s))
      dots.push_back({step.image_s, step.check->depth.value, 2 * step.check->sigma.value});
  return dots;
}

ChartPanel depth_panel(const RunRecord& record) {
  ChartPanel panel;
  panel.y_title = "Depth (mm)";
  panel.height_px = 250;
  panel.levels = depth_levels(record);
  panel.y_high = highest(record, 1.0, [](const Sample& s) { return std::max(s.depth_mm, s.setpoint_mm); });
  for (const ChartLevel& level : panel.levels) panel.y_high = std::max(panel.y_high, level.y);
  panel.y_high *= 1.06;
  panel.y_low = -0.06 * panel.y_high;
  for (const Sample& sample : record.samples)
    panel.y_low = std::min(panel.y_low, static_cast<double>(sample.depth_mm));
  panel.lines = {line(record, "laser", {"#7d8a95", 1.6, ""}, [](const Sample& s) { return s.depth_mm; })};
  if (record.simulated)
    panel.lines.push_back(
        line(record, "true tip (simulated)", {"#22303c", 1.2, ""}, [](const Sample& s) { return s.tip_mm; }));
  panel.lines.push_back(
      line(record, "plan", {"#0d141a", 1.6, "7 4"}, [](const Sample& s) { return s.setpoint_mm; }));
  panel.dots = image_depths(record);
  panel.dots_name = "image, ± 2 standard deviations";
  return panel;
}

ChartPanel drive_panel(const RunRecord& record) {
  ChartPanel panel;
  panel.y_title = "Drive (kV)";
  panel.height_px = 200;
  panel.y_high = 1.1 * highest(record, 1.0,
                               [](const Sample& s) { return std::max(std::abs(s.drive_kV), s.envelope_kV); });
  panel.y_low = -panel.y_high;
  const Stroke envelope{"#0d141a", 1.3, "6 3"};
  panel.lines = {
      line(record, "voltage monitor", {"#b4bcc3", 3.0, ""}, [](const Sample& s) { return s.monitor_kV; }),
      line(record, "drive", {"#3a4a57", 1.1, ""}, [](const Sample& s) { return s.drive_kV; }),
      line(record, "envelope of the permit", envelope, [](const Sample& s) { return s.envelope_kV; }),
      line(record, "", envelope, [](const Sample& s) { return -s.envelope_kV; })};
  return panel;
}

std::vector<ChartState> supervisor_states(const RunRecord& record) {
  std::vector<ChartState> states;
  for (const Mode mode : {Mode::Boot, Mode::Safe, Mode::Ready, Mode::Armed, Mode::Active, Mode::Hold,
                          Mode::Retract, Mode::Trip, Mode::Lock}) {
    ChartState state{std::string(label(mode)), mode == Mode::Trip || mode == Mode::Lock,
                     spans(record, [mode](const Sample& s) { return s.mode == mode; })};
    if (!state.spans.empty()) states.push_back(std::move(state));
  }
  return states;
}

bool driving(const Sample& sample) {
  return sample.mode == Mode::Active || sample.mode == Mode::Hold;
}

std::vector<ChartBand> step_bands(const RunRecord& record) {
  std::vector<ChartBand> bands;
  for (std::size_t i = 0; i < record.steps.size(); ++i) {
    const auto times = spans(record, [i](const Sample& s) { return s.step == i && driving(s); });
    if (times.empty()) continue;
    const InsertionStep& step = record.steps[i].step;
    bands.push_back({{times.front().x_from, times.back().x_to},
                     fmt::format("{} {} to {}", i + 1, label(step.kind), fixed(step.depth.value, 2, "mm")),
                     std::to_string(i + 1)});
  }
  return bands;
}

std::vector<ChartMarker> markers(const RunRecord& record) {
  std::vector<ChartMarker> marks;
  for (std::size_t i = 0; i < record.steps.size(); ++i)
    if (std::isfinite(record.steps[i].image_s))
      marks.push_back({record.steps[i].image_s, fmt::format("image {}", i + 1), false});
  for (std::size_t i = 0; i < record.trips.size(); ++i)
    marks.push_back({record.trips[i].time_s, fmt::format("trip {}", i + 1), true});
  std::stable_sort(marks.begin(), marks.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
  return marks;
}

}  // namespace

std::string run_figure(const RunRecord& record) {
  if (record.samples.empty()) return {};
  Chart chart;
  chart.title = "Depth, drive voltage and supervisor state over time";
  chart.description =
      "Above: depth by laser with the plan's setpoint. Middle: drive voltage with the permit's envelope. "
      "Below: the supervisor's states. The numbers are in run.csv.";
  chart.note = record.simulated ? "SIMULATED" : "";
  chart.x_title = "Time from the start of the run (s)";
  chart.x_low = seconds(record.samples.front());
  chart.x_high = seconds(record.samples.back()) + kTick_s;
  chart.panels = {depth_panel(record), drive_panel(record)};
  chart.states_title = "Supervisor";
  chart.states = supervisor_states(record);
  chart.bands = step_bands(record);
  chart.markers = markers(record);
  return render(chart);
}

}  // namespace biopsy::report
