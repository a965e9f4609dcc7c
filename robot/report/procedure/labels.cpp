#include "robot/report/procedure/labels.hpp"

#include <array>

namespace biopsy::report {
namespace {

template <class Enumeration, std::size_t Count>
std::string_view label_in(const std::array<std::string_view, Count>& labels, Enumeration value) {
  const auto index = static_cast<std::size_t>(value);
  return index < Count ? labels[index] : "unknown";
}

// In the order of the enumerations.
constexpr std::array<std::string_view, 3> kOutcomes{"completed", "refused", "stopped"};
constexpr std::array<std::string_view, 9> kModes{"boot", "safe",    "ready", "armed", "active",
                                                 "hold", "retract", "trip",  "lock"};
constexpr std::array<std::string_view, 4> kStops{"none", "C2 hold", "C1 ramp", "C0 off"};
constexpr std::array<std::string_view, 11> kGateVerdicts{
    "refused", "granted",       "no permit",  "wrong session", "old epoch", "old sequence",
    "expired", "second writer", "clock jump", "no request",    "limited"};
constexpr std::array<std::string_view, 4> kSteps{"approach", "cross", "waypoint", "target"};
constexpr std::array<std::string_view, 3> kDepthVerdicts{"unsure", "accept", "reject"};

static_assert(kOutcomes.size() == static_cast<std::size_t>(Outcome::Stopped) + 1);
static_assert(kModes.size() == static_cast<std::size_t>(Mode::Lock) + 1);
static_assert(kStops.size() == static_cast<std::size_t>(StopCategory::C0Off) + 1);
static_assert(kGateVerdicts.size() == static_cast<std::size_t>(GateVerdict::Limited) + 1);
static_assert(kSteps.size() == static_cast<std::size_t>(StepKind::Target) + 1);
static_assert(kDepthVerdicts.size() == static_cast<std::size_t>(DepthVerdict::Reject) + 1);

}  // namespace

std::string_view label(Outcome outcome) {
  return label_in(kOutcomes, outcome);
}

std::string_view label(Mode mode) {
  return label_in(kModes, mode);
}

std::string_view label(StopCategory stop) {
  return label_in(kStops, stop);
}

std::string_view label(GateVerdict verdict) {
  return label_in(kGateVerdicts, verdict);
}

std::string_view label(StepKind kind) {
  return label_in(kSteps, kind);
}

std::string_view label(DepthVerdict verdict) {
  return label_in(kDepthVerdicts, verdict);
}

}  // namespace biopsy::report
