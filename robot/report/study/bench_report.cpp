#include "robot/report/study/bench_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robot/common/text/number_text.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/report/markup/html_markup.hpp"
#include "robot/report/plot/svg_chart.hpp"

namespace biopsy::report {
namespace {

constexpr int kBenchColumns = 375;  // four points each: at most 1500 a line

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

double seconds_of(const BenchRunRecord& run) {
  return run.time_s.empty() ? 0.0 : run.time_s.back();
}

std::string outcome_of(const BenchRunRecord& run) {
  return run.stopped_because.empty()
             ? "complete"
             : fmt::format("stopped at {:.2f} s, {}", run.stopped_s, run.stopped_because);
}

ChartPanel panel_of(const BenchRunRecord& run, const std::string& title, const std::vector<double>& values,
                    double height) {
  std::vector<Vertex> points;
  for (std::size_t i = 0; i < values.size(); ++i) points.push_back({run.time_s[i], values[i]});
  return autoscaled_panel(title, height, {{"", {}, decimated(points, 0.0, seconds_of(run), kBenchColumns)}});
}

std::string picture_of(const BenchRunRecord& run) {
  if (run.time_s.size() < 2) return {};
  Chart chart;
  chart.title = run.name;
  chart.description = run.what;
  chart.x_title = "Time (s)";
  chart.x_high = seconds_of(run);
  chart.panels = {panel_of(run, "Drive (kV)", run.drive_kV, 90),
                  panel_of(run, "Displacement (mm)", run.displacement_mm, 150)};
  if (largest(run.push_N) > 0.0) chart.panels.push_back(panel_of(run, "Push (N)", run.push_N, 70));
  if (!run.stopped_because.empty()) chart.markers = {{run.stopped_s, "stopped", true}};
  return render(chart);
}

std::string table_of(const BenchRecord& record) {
  std::string rows;
  for (const BenchRunRecord& run : record.runs)
    rows += markup::row(
        {markup::name_cell(run.name, run.name), markup::text_cell(run.what),
         markup::number_cell(run.weight_g, 0), markup::number_cell(seconds_of(run), 1),
         markup::number_cell(largest(run.drive_kV), 2), markup::number_cell(run.expected_mm, 1),
         markup::number_cell(largest(run.displacement_mm), 2), markup::text_cell(outcome_of(run))});
  return markup::table(
      "", {"Run", "What", ">Weight, g", ">Time, s", ">Drive, kV", ">Expected, mm", ">Travel, mm", "Outcome"},
      rows);
}

}  // namespace

std::string bench_html(const BenchRecord& record) {
  std::string notes;
  for (const std::string& note : record.notes) notes += markup::paragraph(note);
  std::string pictures;
  for (const BenchRunRecord& run : record.runs)
    pictures += markup::figure(picture_of(run), "<strong>" + escaped(run.name) + "</strong>: " +
                                                    escaped(run.what + "; " + outcome_of(run)));
  const std::string facts =
      markup::facts({{"device", record.device},
                     {"model", record.model},
                     {"runs", fmt::format("{} of {}", record.runs.size(), record.planned_runs)},
                     {"laser's noise at rest",
                      record.sensor_noise_mm > 0.0 ? fixed(record.sensor_noise_mm, 4, "mm") : ""}});
  const std::string banner =
      record.simulated ? "<p class=\"simulated\"><strong>SIMULATED</strong> No stage moved.</p>\n" : "";
  return markup::page({.title = record.title, .style = markup::kGapStyle, .banner = banner},
                      markup::section("Experiments", facts + notes) +
                          markup::section("Runs", table_of(record)) + markup::section("Pictures", pictures));
}

std::string bench_console(const BenchRecord& record) {
  std::string text = fmt::format("{:<24} {:>8} {:>8} {:>9} {:>12} {:>10}  {}\n", "run", "weight g", "time s",
                                 "drive kV", "expected mm", "travel mm", "outcome");
  for (const BenchRunRecord& run : record.runs)
    text += fmt::format("{:<24} {:>8.0f} {:>8.1f} {:>9.2f} {:>12.1f} {:>10.2f}  {}\n", run.name, run.weight_g,
                        seconds_of(run), largest(run.drive_kV), run.expected_mm, largest(run.displacement_mm),
                        outcome_of(run));
  if (record.runs.size() < record.planned_runs)
    text += fmt::format("{} of {} runs were not begun\n", record.planned_runs - record.runs.size(),
                        record.planned_runs);
  for (const std::string& note : record.notes) text += plain(note) + "\n";
  return text;
}

}  // namespace biopsy::report
