// Records of the procedure log: as given to the recorder, and as read back.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "robot/msg/plan.hpp"

namespace biopsy::recorder {

enum class RecordKind : std::uint8_t {
  ProcessStart,
  ProcessStop,
  Plan,
  OperatorAct,
  Request,
  RequestRefused,
  PermitChange,
  StateChange,
  DepthCheck,
  Alarm,
  Commissioning,
  ReceptionGap,  // messages that did not reach the recorder
  RecordsLost,   // of the recorder itself: writing failed and memory was full
  PlanConfirmation,
};
inline constexpr std::size_t kRecordKinds = 14;

// Written and hashed: never change one, only add.
constexpr const char* name_of(RecordKind kind) {
  constexpr std::array<const char*, kRecordKinds> kNames{
      "process start",   "process stop",  "plan",         "operator act",     "request",
      "request refused", "permit change", "state change", "depth check",      "alarm",
      "commissioning",   "reception gap", "records lost", "plan confirmation"};
  return kNames[static_cast<std::size_t>(kind)];
}

// Urgent: transitions and trips, written at once. The others wait for their group.
enum class Urgency : std::uint8_t { Grouped, Urgent };

struct Entry {
  std::int64_t utc_ns = 0;   // wall clock of the source, since 1970; decides nothing
  std::int64_t mono_us = 0;  // its monotonic clock
  std::string source;        // process that it comes from
  RecordKind kind = RecordKind::Alarm;
  std::string body;  // JSON or text, UTF-8
};

struct Record {
  std::uint64_t seq = 0;  // from 1, without gaps
  std::int64_t utc_ns = 0, mono_us = 0;
  std::string source, kind, body;
  Sha256 previous{}, hash{};
};

}  // namespace biopsy::recorder
