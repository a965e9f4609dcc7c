// The names that people and files use for the enumerations of the messages.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "robot/report/procedure/run_record.hpp"

namespace biopsy::report {

// In the order of each enumeration; its last value, to check that none is missing.
template <class Enumeration>
struct Labels;
template <>
struct Labels<Outcome> {
  static constexpr auto kLast = Outcome::Stopped;
  static constexpr auto kNames = std::to_array<std::string_view>({"completed", "refused", "stopped"});
};
template <>
struct Labels<Mode> {
  static constexpr auto kLast = Mode::Lock;
  static constexpr auto kNames = std::to_array<std::string_view>(
      {"boot", "safe", "ready", "armed", "active", "hold", "retract", "trip", "lock"});
};
template <>
struct Labels<StopCategory> {
  static constexpr auto kLast = StopCategory::C0Off;
  static constexpr auto kNames = std::to_array<std::string_view>({"none", "C2 hold", "C1 ramp", "C0 off"});
};
template <>
struct Labels<GateVerdict> {
  static constexpr auto kLast = GateVerdict::Limited;
  static constexpr auto kNames = std::to_array<std::string_view>(
      {"refused", "granted", "no permit", "wrong session", "old epoch", "old sequence", "expired",
       "second writer", "clock jump", "no request", "limited"});
};
template <>
struct Labels<StepKind> {
  static constexpr auto kLast = StepKind::Target;
  static constexpr auto kNames = std::to_array<std::string_view>({"approach", "cross", "waypoint", "target"});
};
template <>
struct Labels<DepthVerdict> {
  static constexpr auto kLast = DepthVerdict::Reject;
  static constexpr auto kNames = std::to_array<std::string_view>({"unsure", "accept", "reject"});
};

template <class Enumeration>
constexpr std::string_view label(Enumeration value) {
  constexpr auto& kNames = Labels<Enumeration>::kNames;
  static_assert(kNames.size() == static_cast<std::size_t>(Labels<Enumeration>::kLast) + 1);
  const auto index = static_cast<std::size_t>(value);
  return index < kNames.size() ? kNames[index] : "unknown";
}

// The value that has this name; none: no value has.
template <class Enumeration>
constexpr std::optional<Enumeration> labelled(std::string_view name) {
  constexpr auto& kNames = Labels<Enumeration>::kNames;
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<Enumeration>(found - kNames.begin());
}

}  // namespace biopsy::report
