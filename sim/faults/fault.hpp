// One fault of a simulated stage, its links or its panel, as an assessor describes it: what breaks, how, from
// when to when, and how much. Made without knowledge of any monitor.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace biopsy::sim {

enum class FaultSignal : std::uint8_t {
  Depth,           // reading of the laser, mm
  DepthB,          // reading of the second laser, mm
  VoltageMonitor,  // V
  CurrentMonitor,  // A
  Drive,           // output of the amplifier, V; its enable works on
  Brake,           // 1: grips, 0: lets go; Scale: of the force with which it holds
  Measurement,     // link from the stage to the supervisor
  Request,         // link from the controller to supervisor and gate
  Permit,          // link from the supervisor to the gate
  EStopA,          // contacts on the panel
  EStopB,
  ArmKey,
  ResetKey,
  Relay,  // feedback contact of the interlock
};

enum class FaultKind : std::uint8_t {
  Frozen,           // stays at its last value; of a link: nothing new arrives
  Replay,           // repeats its last `value` ms
  Offset,           // adds `value`
  Scale,            // times `value`; 0: dead
  Drift,            // adds `value` for each second since it began
  Lag,              // arrives `value` ms late
  Quantised,        // in steps of `value`
  Inverted,         // sign turned; of a contact: open for closed
  Dropout,          // a share `value` of the samples is lost: no target, 0 V, no message
  OtherSurface,     // stays at `value`, whatever the needle does
  Noise,            // only the noise below
  Oscillation,      // adds a 50 Hz sine of amplitude `value`
  MissingPolarity,  // one sign is lost: the positive one where `value` > 0
  Command,          // of the voltage monitor: what was asked of the amplifier, whatever it puts out
};

inline constexpr std::size_t kMostFaults = 32;  // in one run

struct Fault {
  FaultSignal signal = FaultSignal::Depth;
  FaultKind kind = FaultKind::Frozen;
  // When it begins: with both, the later; with none, with the run.
  std::optional<double> from_depth_mm{};  // true depth of the needle
  std::optional<double> from_s{};         // from arming (high voltage first enabled)
  std::optional<double> until_s{};        // from arming; it then ends for good
  double value = 0.0;                     // in the signal's unit, see FaultKind
  double noise = 0.0;                     // standard deviation on what the fault shows, the signal's unit
  // An intermittent fault: it shows for `on_ms`, not for `off_ms`, and so on while it lasts. 0: it always
  // shows.
  std::int32_t on_ms = 0, off_ms = 0;
};

std::string_view name_of(FaultSignal signal);
std::string_view name_of(FaultKind kind);

constexpr bool is_link(FaultSignal signal) {
  return signal >= FaultSignal::Measurement && signal <= FaultSignal::Permit;
}
constexpr bool is_contact(FaultSignal signal) {
  return signal >= FaultSignal::EStopA;
}

}  // namespace biopsy::sim
