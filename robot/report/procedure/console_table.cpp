#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robot/common/text/number_text.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/common/text/text_layout.hpp"
#include "robot/report/procedure/labels.hpp"
#include "robot/report/procedure/report.hpp"
#include "robot/report/procedure/verdict.hpp"

namespace biopsy::report {
namespace {

enum class Side { Left, Right };

class Columns {
 public:
  explicit Columns(std::vector<Side> sides) : sides_(std::move(sides)), widths_(sides_.size(), 0) {}

  void add(std::vector<std::string> cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) widths_[i] = std::max(widths_[i], display_width(cells[i]));
    rows_.push_back(std::move(cells));
  }

  std::string lines(const std::string& heading_start, const std::string& heading_end) const {
    std::string text;
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      std::string line;
      for (std::size_t i = 0; i < rows_[r].size(); ++i)
        line += "  " + (sides_[i] == Side::Left ? padded_right(rows_[r][i], widths_[i])
                                                : padded_left(rows_[r][i], widths_[i]));
      line.erase(line.find_last_not_of(' ') + 1);
      text.append(r == 0 ? heading_start : "").append(line).append(r == 0 ? heading_end : "").append("\n");
    }
    return text;
  }

 private:
  std::vector<Side> sides_;
  std::vector<std::size_t> widths_;
  std::vector<std::vector<std::string>> rows_;
};

struct Ink {
  const char *bold, *alarm, *plain;
};

Ink ink_for(bool colour) {
  return colour ? Ink{"\033[1m", "\033[1;31m", "\033[0m"} : Ink{"", "", ""};
}

std::string known_parts(const std::vector<std::string>& parts) {
  std::vector<std::string> known;
  for (const std::string& part : parts)
    if (!part.empty()) known.push_back(plain(part));
  return known.empty() ? "–" : joined(known);
}

std::string layer_list(const Plan& plan) {
  std::vector<std::string> layers;
  for (const Layer& layer : plan.layers)
    layers.push_back(plain(layer.name) + " " + fixed(layer.from.value, 2) + " to " +
                     fixed(layer.to.value, 2));
  return layers.empty() ? "–" : joined(layers, " | ") + " mm";
}

std::string plan_lines(const RunRecord& record) {
  const SeriesIdentity& series = record.series;
  std::string text =
      "  Patient  " + known_parts({person_name(series.patient_name), series.patient_id}) + "\n  Series   " +
      known_parts({series.modality, series.description, series.date, record.image_source}) + "\n";
  for (const std::string& warning : record.image_warnings) text += "  Warning  " + plain(warning) + "\n";
  if (!record.plan) return text;
  if (record.registration == "assumed")
    text += "  Warning  the robot's place is assumed: aimed at the entry along the path, not registered\n";
  const Point target = ras_from_lps(record.plan->target.p_ST);
  return text +
         fmt::format("  Target   {} deep, at R, A, S {}, {}, {} mm; {} beside the axis\n",
                     fixed(record.plan->target_depth.value, 2, "mm"), fixed(target.x(), 1),
                     fixed(target.y(), 1), fixed(target.z(), 1),
                     fixed(record.plan->axis_offset.value, 2, "mm")) +
         "  Layers   " + layer_list(*record.plan) + "\n";
}

std::string image_text(const StepResult& step) {
  if (!step.check) return "–";
  std::string verdict(label(step.check->verdict));
  if (!step.check->tip_found) return verdict;
  return fmt::format("{} ± {} {}", fixed(step.check->depth.value, 2), fixed(step.check->sigma.value, 2),
                     verdict);
}

std::string step_lines(const RunRecord& record, const Ink& ink) {
  const std::vector<StepResult> steps = driven_or_planned_steps(record);
  if (steps.empty()) return {};
  Columns columns({Side::Right, Side::Left, Side::Right, Side::Right, Side::Right, Side::Right, Side::Right,
                   Side::Left, Side::Left});
  columns.add({"No", "Step", "Plan mm", "mm/s", "Reached s", "Laser mm", "RMSE mm", "Image mm", "Layer"});
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const StepResult& s = steps[i];
    columns.add({std::to_string(i + 1), std::string(label(s.step.kind)), fixed(s.step.depth.value, 2),
                 fixed(s.step.speed.value, 2), s.reached ? fixed(s.reached_s, 2) : "not",
                 fixed(s.depth_mm, 3), fixed(s.rmse_settled_mm, 3), image_text(s),
                 s.layer_at_tip.empty() ? "–" : plain(s.layer_at_tip)});
  }
  return columns.lines(ink.bold, ink.plain) + "\n";
}

std::string gauge(double percent) {
  constexpr int kMarks = 20;
  const double shown = std::isfinite(percent) ? std::clamp(percent, 0.0, 100.0) : 0.0;
  const int full = static_cast<int>(std::lround(shown / 100.0 * kMarks));
  return "[" + std::string(static_cast<std::size_t>(full), '#') +
         std::string(static_cast<std::size_t>(kMarks - full), '.') + "]";
}

std::string limit_lines(const RunRecord& record, const Ink& ink) {
  if (record.limits.empty()) return {};
  Columns columns(
      {Side::Left, Side::Right, Side::Right, Side::Right, Side::Left, Side::Right, Side::Left, Side::Left});
  columns.add({"Limit", "Used", "Limit", "Margin", "", "Used %", "", ""});
  for (const LimitUse& use : record.limits) {
    const double percent = used_percent(use);
    columns.add({plain(use.name), fixed(use.used, 2), fixed(use.limit, 2), fixed(use.limit - use.used, 2),
                 plain(use.unit), fixed(percent, 0), gauge(percent),
                 percent > 100.0 ? "BEYOND THE LIMIT" : ""});
  }
  return columns.lines(ink.bold, ink.plain) + "\n";
}

std::string trip_lines(const RunRecord& record, const Ink& ink) {
  std::string text;
  for (const Trip& trip : record.trips)
    text += fmt::format("  {}Trip{} at {}, {}: {}\n", ink.alarm, ink.plain, fixed(trip.time_s, 3, "s"),
                        label(trip.stop), plain(trip.reason));
  return text.empty() ? text : text + "\n";
}

}  // namespace

std::string console_table(const RunRecord& record, bool colour) {
  const Ink ink = ink_for(colour);
  const bool alarm = record.outcome == Outcome::Stopped;
  return fmt::format("{}{}{}{}\n\n", ink.bold, record.simulated ? "SIMULATED  " : "", plain(record.title),
                     ink.plain) +
         plan_lines(record) + "\n" + step_lines(record, ink) + limit_lines(record, ink) +
         trip_lines(record, ink) +
         fmt::format("{}{}{}\n", alarm ? ink.alarm : ink.bold, plain(verdict_sentence(record)), ink.plain);
}

}  // namespace biopsy::report
