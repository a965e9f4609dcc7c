// Every hazard the supervisor monitors, one row each, worst first: its stop, time, requirement, monitor and
// threshold.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "robot/msg/fixed_messages.hpp"

namespace biopsy::safety {

// The order is the order of severity: where several are present, the first one is named.
enum class Hazard : std::uint8_t {
  ResidualCharge,
  NeedleNotBack,  // lock
  EStop,
  EStopDisagrees,
  ClockJump,
  OverVoltage,
  Arc,
  MonitorDisagrees,
  DriverDisobeys,
  WrongAnswer,
  SecondWriter,
  ControllerSilent,
  PlanChanged,
  ConfigChanged,
  HardOverDepth,
  FastDrop,
  InterlockStuck,  // C0
  OverDepth,
  PopThrough,
  SensorStale,
  SensorFrozen,
  LaserDropout,
  OffsetOrScale,
  PolarityStuck,
  WrongFrequency,
  LoopOverrun,
  MessageOrder,
  WrongTissueModel,
  LogBacklog,
  PlanImplausible,
  PlanUnconfirmed,
  PanelUntested,  // C1
  StepDepth,
  SuspectTissueModel,
  PatientMotion,  // C2
  None,           // nothing found; not a hazard
};
inline constexpr std::size_t kHazards = static_cast<std::size_t>(Hazard::None);

// The monitor that finds it.
enum class Monitor : std::uint8_t { Link, Voltage, Depth, Tissue };

// One row of the table of hazards, from which the one in the documentation comes.
struct HazardFacts {
  Hazard hazard;
  StopCategory stop;  // reaction while the drive is enabled; in every other state it refuses Ready and arming
  std::int32_t detect_ms;  // from the first sample that shows it to the evidence that names it, at most
  std::string_view name;   // hazard of the risk analysis (safety/case/hazards.toml) and sentence for a person
  std::string_view requirement;
  Monitor monitor;
  std::string_view threshold;  // as in limits.hpp and thresholds.hpp
  bool locks = false;          // leads to Lock, not to Trip
};

// The times are those of the safety concept (C0 budget 10 ms in all).
inline constexpr std::array<HazardFacts, kHazards> kHazardTable{{
    {Hazard::ResidualCharge, StopCategory::C0Off, 200, "H-06 voltage remains after switching off", "R-01",
     Monitor::Voltage, "more than 100 V, 200 ms after off", true},
    {Hazard::NeedleNotBack, StopCategory::C0Off, 500, "H-07 needle did not return at zero volts", "R-02",
     Monitor::Depth, "deeper than 1 mm, 500 ms after 0 V"},
    {Hazard::EStop, StopCategory::C0Off, 1, "H-25 emergency stop pressed or unread", "R-03", Monitor::Link,
     "either contact open, or the panel unread for more than 20 ms; until the reset key is turned"},
    {Hazard::EStopDisagrees, StopCategory::C0Off, 21, "H-26 emergency stop channels disagree", "R-04",
     Monitor::Link, "contacts differ for more than 20 ms; stays until both were seen open"},
    {Hazard::ClockJump, StopCategory::C0Off, 1, "H-16 clock jumped or stood still", "R-05", Monitor::Link,
     "step of 0 or less, or above 5 ms, on either clock"},
    {Hazard::OverVoltage, StopCategory::C0Off, 2, "H-02 high voltage above its limit", "R-06",
     Monitor::Voltage, "monitor above 8.2 kV, 2 samples"},
    {Hazard::Arc, StopCategory::C0Off, 5, "H-03 current above what the capacitance explains: arc", "R-07",
     Monitor::Voltage, "1 mA above what C1 explains, 2 samples, or more than a third of them"},
    {Hazard::MonitorDisagrees, StopCategory::C0Off, 4, "H-04 voltage monitor disagrees with the command",
     "R-08", Monitor::Voltage,
     "off by more than 3 % (at least 100 V), 3 samples, or more than a third of them"},
    {Hazard::DriverDisobeys, StopCategory::C0Off, 4, "H-04 driver does not follow the permit", "R-09",
     Monitor::Voltage, "more than 200 V above the permit that it answered, 3 ticks"},
    {Hazard::WrongAnswer, StopCategory::C0Off, 7, "H-17 driver answers the challenge wrongly or not at all",
     "R-10", Monitor::Link, "score: wrong +2, right -1, above 2; or a permit expired at the driver"},
    {Hazard::SecondWriter, StopCategory::C0Off, 1, "H-18 not exactly one writer of requests and permits",
     "R-11", Monitor::Link, "writers not 1"},
    // A controller that died is a drive without a loop: the gate would only hold its last amplitude.
    {Hazard::ControllerSilent, StopCategory::C0Off, 4, "H-15 no new request from the controller", "R-25",
     Monitor::Link, "none to more than 3 measurements in a row"},
    {Hazard::PlanChanged, StopCategory::C0Off, 1, "H-19 plan is missing or is not the sealed one", "R-12",
     Monitor::Link, "seal differs from that of the sealed plan, or none"},
    {Hazard::ConfigChanged, StopCategory::C0Off, 1, "H-29 configuration is not the one at start", "R-13",
     Monitor::Link, "tag differs from the one at start"},
    {Hazard::HardOverDepth, StopCategory::C0Off, 2, "H-01 needle beyond the plan and its margin", "R-14",
     Monitor::Depth, "more than plan + 1 mm, or stopping point beyond plan + 2 mm, 2 samples"},
    {Hazard::FastDrop, StopCategory::C0Off, 16, "H-05 needle fell back: drive lost", "R-15", Monitor::Depth,
     "back faster than 50 mm/s"},
    {Hazard::InterlockStuck, StopCategory::C0Off, 31, "H-45 interlock relay is not where it was commanded",
     "R-65", Monitor::Link, "feedback contact unlike both pulses for more than 30 ms"},
    {Hazard::OverDepth, StopCategory::C1Ramp, 2, "H-01 needle would pass the planned depth", "R-16",
     Monitor::Depth, "stopping point beyond the plan's depth limit, 2 samples"},
    {Hazard::PopThrough, StopCategory::C1Ramp, 10, "H-23 needle broke through a boundary", "R-17",
     Monitor::Depth, "more than 0.8 mm within 10 ms, 2 samples"},
    {Hazard::SensorStale, StopCategory::C1Ramp, 4, "H-08 no new measurement", "R-18", Monitor::Link,
     "none for more than 3 ms"},
    {Hazard::SensorFrozen, StopCategory::C1Ramp, 20, "H-09 depth sensor frozen while the voltage moves",
     "R-19", Monitor::Depth,
     "same code for 20 ms while the drive moves by more than 200 V, or, the brake off, V squared 24 kV^2 "
     "above its value at the deepest depth seen"},
    {Hazard::LaserDropout, StopCategory::C1Ramp, 3, "H-11 depth sensor has no target", "R-20", Monitor::Depth,
     "3 samples, or more than a third of them, of either laser without a target (the second only with a "
     "patient)"},
    {Hazard::OffsetOrScale, StopCategory::C1Ramp, 50, "H-10 depth reading is not plausible", "R-21",
     Monitor::Depth,
     "with a patient, the two lasers more than 0.3 mm apart for 10 ms, or in more than a fifth of the "
     "samples; "
     "more than 1 mm outside the plausible band for 50 ms; with a patient, back by more than 0.6 mm for 20 "
     "ms without the drive having been lowered in the last 4 s and not raised since, or the brake having let "
     "go 250 ms before"},
    {Hazard::PolarityStuck, StopCategory::C1Ramp, 1500, "H-12 polarity is unbalanced: charge builds up",
     "R-22", Monitor::Voltage, "charge of the square wave unbalanced over about four periods"},
    {Hazard::WrongFrequency, StopCategory::C1Ramp, 1300, "H-13 polarity changes at the wrong rate", "R-23",
     Monitor::Voltage,
     "off by more than 20 % over two periods (2 Hz, or what a plan for the bench declares), or with a "
     "patient late by so much since any of the last four changes"},
    {Hazard::LoopOverrun, StopCategory::C1Ramp, 4, "H-14 control loop missed three periods", "R-24",
     Monitor::Link,
     "third within 100 ms: periods that the controller missed, and ticks of the stage that left one out"},
    {Hazard::MessageOrder, StopCategory::C1Ramp, 3, "H-17 messages lost, repeated or out of order", "R-26",
     Monitor::Link, "score as for R-10"},
    {Hazard::WrongTissueModel, StopCategory::C1Ramp, 1100, "H-21 tissue keeps behaving unlike the plan",
     "R-27", Monitor::Tissue, "as for R-32, 1.1 s"},
    {Hazard::LogBacklog, StopCategory::C1Ramp, 1, "H-30 procedure log cannot be written", "R-28",
     Monitor::Link, "backlog above 1 s"},
    {Hazard::PlanImplausible, StopCategory::C1Ramp, 1, "H-20 plan is outside what the robot can do (units?)",
     "R-29", Monitor::Link,
     "numbers of the plan that no robot of this kind can mean, a step beyond the drives that the plausible "
     "band knows, or with a patient a depth limit or a band wider than the supervisor allows, a step back, "
     "a last step without an image, or a band that does not begin at rest"},
    {Hazard::PlanUnconfirmed, StopCategory::C1Ramp, 1, "H-19 plan lacks its two confirmations", "R-30",
     Monitor::Link,
     "two confirmations of this very plan are missing; for a bench plan also no patient and no needle"},
    {Hazard::PanelUntested, StopCategory::C1Ramp, 1, "H-45 emergency stop and reset key are not tested",
     "R-66", Monitor::Link,
     "both contacts seen open, closed again and the reset key turned: not since the start, or not "
     "for a day; or a key turned for 10 s without voltage"},
    {Hazard::StepDepth, StopCategory::C2Hold, 2, "H-01 needle would pass the depth of its step", "R-31",
     Monitor::Depth, "stopping point beyond the step's depth + 0.5 mm, 2 samples"},
    {Hazard::SuspectTissueModel, StopCategory::C2Hold, 100, "H-21 tissue behaves unlike the plan", "R-32",
     Monitor::Tissue, "more than 0.5 mm outside the plausible band for 0.1 s"},
    {Hazard::PatientMotion, StopCategory::C2Hold, 1, "H-22 patient moved", "R-33", Monitor::Link,
     "more than 2 mm, or not measured"},
}};

consteval bool is_ordered_by_severity() {
  for (std::size_t i = 0; i < kHazards; ++i) {
    if (kHazardTable[i].hazard != static_cast<Hazard>(i)) return false;
    if (i > 0 && kHazardTable[i].stop > kHazardTable[i - 1].stop) return false;
  }
  return true;
}
static_assert(is_ordered_by_severity());

// A set of hazards, one bit each.
using HazardSet = std::uint64_t;
constexpr HazardSet bit(Hazard hazard) {
  return HazardSet{1} << static_cast<unsigned>(hazard);
}
inline constexpr HazardSet kAllHazards = bit(Hazard::None) - 1;

constexpr HazardSet hazards_with(StopCategory stop) {
  HazardSet set = 0;
  for (const HazardFacts& facts : kHazardTable) set |= facts.stop == stop ? bit(facts.hazard) : 0;
  return set;
}
constexpr HazardSet locking_hazards() {
  HazardSet set = 0;
  for (const HazardFacts& facts : kHazardTable) set |= facts.locks ? bit(facts.hazard) : 0;
  return set;
}
constexpr Hazard worst_of(HazardSet set) {
  return (set & kAllHazards) == 0 ? Hazard::None : static_cast<Hazard>(std::countr_zero(set & kAllHazards));
}
constexpr std::string_view name_of(Monitor monitor) {
  constexpr std::string_view kNames[] = {"link", "voltage", "depth", "tissue"};
  return kNames[static_cast<std::size_t>(monitor)];
}
constexpr std::string_view name_of(Hazard hazard) {
  return hazard < Hazard::None ? kHazardTable[static_cast<std::size_t>(hazard)].name : "none";
}

}  // namespace biopsy::safety
