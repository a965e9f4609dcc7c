#include "tests/verification/fault_injection/evaluate.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "safety/types/transitions.hpp"

namespace biopsy::fault_injection {
namespace {

constexpr std::size_t kNever = static_cast<std::size_t>(-1);

template <class Is>
std::size_t first_where(std::span<const TickRecord> lines, std::size_t from, Is&& is) {
  for (std::size_t i = from; i < lines.size(); ++i)
    if (is(lines[i])) return i;
  return kNever;
}

// The first of `row` samples in a row that show the fault.
std::size_t first_shown(std::span<const TickRecord> lines, std::int32_t row) {
  std::int32_t count = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    count = lines[i].shown ? count + 1 : 0;
    if (count == row) return i + 1 - static_cast<std::size_t>(row);
  }
  return kNever;
}

// In milliseconds, both ends counted; 0 where it came before.
std::int32_t span_ms(std::size_t from, std::size_t to) {
  return to < from ? 0 : static_cast<std::int32_t>(to - from) + 1;
}

bool is_idle(Mode mode) {
  return !safety::hv_permitted(mode) && mode != Mode::Ready;
}

bool rises_after(std::span<const TickRecord> lines, std::size_t reacted) {
  std::int32_t lowest = std::abs(lines[reacted].command_mV);
  for (const TickRecord& line : lines.subspan(reacted)) {
    if (line.event == safety::Event::Move) return false;  // a new press, which may
    if (std::abs(line.command_mV) > lowest) return true;
    lowest = std::abs(line.command_mV);
  }
  return false;
}

}  // namespace

bool has_reacted(const FaultClass& fault, const TickRecord& line) {
  const bool gate_off = line.command_mV == 0 && !line.enabled;
  const bool stack_off = std::abs(line.output_kV) < 1e-3;
  switch (fault.reaction) {
    case Reaction::Off:
      return gate_off && stack_off && is_idle(line.mode);
    case Reaction::OutputOff:
      return stack_off;
    case Reaction::Ramp:
      return gate_off && is_idle(line.mode);
    case Reaction::NoRise:
      return is_idle(line.mode) || line.mode == Mode::Hold || line.mode == Mode::Retract;
    case Reaction::Lock:
      return gate_off && line.mode == Mode::Lock;
    case Reaction::Flag:
      return line.flagged;
  }
  return false;
}

Verdict evaluate(const FaultClass& fault, std::span<const TickRecord> lines, double target_mm) {
  Verdict verdict;
  const std::size_t shown = first_shown(lines, fault.row);
  const auto names = [&](safety::HazardSet set) {
    return first_where(lines, 0, [&](const TickRecord& line) { return (line.hazards & set) != 0; });
  };
  const bool unnamed = fault.hazard == safety::Hazard::None;
  const std::size_t begins = shown == kNever ? 0
                             : unnamed       ? shown
                                             : std::min(shown, names(bit(fault.hazard) | fault.instead));
  const std::size_t reacted =
      first_where(lines, begins, [&](const TickRecord& line) { return has_reacted(fault, line); });
  const std::size_t own = unnamed ? reacted : names(bit(fault.hazard));
  const std::size_t other = names(fault.instead);

  for (std::size_t i = 0; i < lines.size(); ++i) {
    verdict.beyond_mm = std::max(verdict.beyond_mm, lines[i].depth_mm - target_mm);
    if (!fault.raises_drive || i > reacted)
      verdict.highest_kV = std::max(verdict.highest_kV, std::abs(lines[i].output_kV));
  }
  verdict.rose = reacted != kNever && fault.reaction != Reaction::Flag && rises_after(lines, reacted);
  if (reacted != kNever) verdict.from_fault_ms = span_ms(0, reacted);

  const std::size_t named = std::min(own, other);
  if (shown == kNever) {
    if (named != kNever && reacted != kNever)
      verdict.outcome = own != kNever && own <= other ? Outcome::Detected : Outcome::ByAnother;
    return verdict;
  }
  verdict.react_ms = reacted == kNever ? 0 : span_ms(shown, reacted);
  const bool in_time = reacted != kNever && verdict.react_ms <= fault.react_ms;
  const bool own_in_time = own != kNever && span_ms(shown, own) <= fault.detect_ms;
  const bool other_in_time = other != kNever && span_ms(shown, other) <= fault.detect_ms;
  verdict.detect_ms = named == kNever ? 0 : span_ms(shown, own_in_time || other == kNever ? own : other);
  if (named == kNever || reacted == kNever)
    verdict.outcome = Outcome::Missed;
  else if (in_time && own_in_time)
    verdict.outcome = Outcome::Detected;
  else if (in_time && other_in_time)
    verdict.outcome = Outcome::ByAnother;
  else
    verdict.outcome = Outcome::Late;
  return verdict;
}

std::string_view name_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::Detected:
      return "detected";
    case Outcome::ByAnother:
      return "detected by another";
    case Outcome::Late:
      return "late";
    case Outcome::Missed:
      return "missed";
    case Outcome::NotShown:
      return "never shown";
  }
  return "unknown";
}

}  // namespace biopsy::fault_injection
