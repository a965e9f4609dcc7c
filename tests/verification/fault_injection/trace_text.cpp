#include "tests/verification/fault_injection/trace_text.hpp"

#include <fmt/format.h>

#include <cmath>

#include "safety/types/transitions.hpp"

namespace biopsy::fault_injection {
namespace {

std::string names_of(safety::HazardSet set) {
  std::string all;
  for (const safety::HazardFacts& facts : safety::kHazardTable)
    if ((set & bit(facts.hazard)) != 0) all += fmt::format("; {}", facts.name);
  return all;
}

// What is new in a line; empty if nothing is.
std::string news(const TickRecord& line, const TickRecord* before, const FaultClass& fault) {
  std::string events;
  if (before == nullptr) events += "; the fault begins";
  if (line.shown && (before == nullptr || !before->shown)) events += "; shown";
  if (before != nullptr && line.mode != before->mode)
    events += fmt::format("; {} -> {}: {}", safety::name_of(before->mode), safety::name_of(line.mode),
                          safety::name_of(line.event));
  const safety::HazardSet was = before == nullptr ? 0 : before->hazards;
  events += names_of(line.hazards & ~was);
  if (has_reacted(fault, line) && (before == nullptr || !has_reacted(fault, *before)))
    events += "; as promised";
  return events.empty() ? events : events.substr(2);
}

}  // namespace

std::string trace_text(const FaultClass& fault, const RunResult& result) {
  const Verdict& v = result.verdict;
  std::string text = fmt::format(
      "{} {}\nbegins at {:.3f} s in {}\n{}: detected after {} ms (allowed {}), reaction after {} ms (allowed "
      "{}), {} ms after it began\ndeepest {:.2f} mm beyond the target, highest {:.2f} kV{}\n\n",
      fault.id, fault.what, static_cast<double>(result.tick) * 1e-3, safety::name_of(result.mode),
      name_of(v.outcome), v.detect_ms, fault.detect_ms, v.react_ms, fault.react_ms, v.from_fault_ms,
      v.beyond_mm, v.highest_kV, v.rose ? "; the voltage ROSE after the stop" : "");
  text += fmt::format("{:>8} {:<8}{:>5}{:>9}{:>9}{:>10}{:>9}  {}\n", "ms", "mode", "stage", "gate kV",
                      "true kV", "laser mm", "true mm", "what is new");
  const TickRecord* before = nullptr;
  for (std::size_t i = 0; i < result.lines.size(); ++i) {
    const TickRecord& line = result.lines[i];
    const std::string events = news(line, before, fault);
    if (!events.empty() || i < 12 || i % 100 == 0)
      text += fmt::format("{:>8} {:<8}{:>5}{:>9.3f}{:>9.3f}{:>10.3f}{:>9.3f}  {}\n", i + 1,
                          safety::name_of(line.mode), line.step, line.command_mV * 1e-6, line.output_kV,
                          line.seen_um * 1e-3, line.depth_mm, events);
    before = &line;
  }
  return text;
}

}  // namespace biopsy::fault_injection
