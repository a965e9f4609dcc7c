#include "drivers/commissioning/run_steps.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace biopsy::commissioning {
namespace {

StepRecord run_step(const Step& step, Rig& rig, Operator& operator_) {
  StepRecord record{std::string(step.name), {}, {}};
  Measured measured{std::vector<double>(step.limits.size(), std::numeric_limits<double>::quiet_NaN()),
                    "was not carried out"};
  if (operator_.confirm(Act::Prepare, std::string(step.instruction))) measured = step.measure(rig, operator_);
  record.note = measured.note;
  for (std::size_t k = 0; k < step.limits.size(); ++k) {
    const Limit& limit = step.limits[k];
    record.figures.push_back({std::string(limit.what), std::string(limit.unit), measured.values.at(k),
                              limit.low, limit.high, std::string(limit.why)});
  }
  return record;
}

std::string with_unit(double value, const std::string& unit) {
  return unit == "1" ? fmt::format("{:.4g}", value) : fmt::format("{:.4g} {}", value, unit);
}

}  // namespace

Record run_steps(Record record, Rig& rig, Operator& operator_) {
  for (const Step& step : all_steps()) {
    operator_.notify(fmt::format("\n{} of {}: {}", record.steps.size() + 1, all_steps().size(), step.name));
    record.steps.push_back(run_step(step, rig, operator_));
    operator_.notify(to_text(record.steps.back()));
    if (!record.steps.back().passed()) break;
  }
  return record;
}

std::string describe_steps() {
  std::string text;
  for (std::size_t k = 0; k < all_steps().size(); ++k) {
    const Step& step = all_steps()[k];
    text += fmt::format("{}. {}\n   {}\n", k + 1, step.name, step.instruction);
    for (const Limit& limit : step.limits)
      text += fmt::format("   - {}: {:g} to {}; {}\n", limit.what, limit.low,
                          with_unit(limit.high, std::string(limit.unit)), limit.why);
  }
  return text;
}

std::string to_text(const StepRecord& step) {
  std::string text;
  for (const Figure& figure : step.figures) {
    if (std::isnan(figure.value)) {
      text += fmt::format("  NO   {}: not measured\n", figure.what);
      continue;
    }
    text += fmt::format("  {:<4} {}: {} ({:g} to {:g})", figure.ok() ? "ok" : "NO", figure.what,
                        with_unit(figure.value, figure.unit), figure.low, figure.high);
    text += figure.ok() ? "\n" : fmt::format("; {}\n", figure.why);
  }
  if (!step.note.empty()) text += fmt::format("       {}\n", step.note);
  return text + (step.passed() ? "  passed" : "  FAILED: this stage must not be used");
}

}  // namespace biopsy::commissioning
