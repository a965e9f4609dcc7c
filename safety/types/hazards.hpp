// Every hazard the supervisor watches for: its stop, its time and its requirement, in one table, worst first.
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
  FastDrop,  // C0
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
  PlanUnconfirmed,  // C1
  StageDepth,
  SuspectTissueModel,
  PatientMotion,  // C2
  None,           // nothing found; not a hazard
};
inline constexpr std::size_t kHazards = static_cast<std::size_t>(Hazard::None);

struct HazardFacts {
  Hazard hazard;
  StopCategory stop;  // reaction while the drive is enabled; in every other state it refuses Ready and arming
  std::int32_t detect_ms;  // from the first sample that shows it to the evidence that names it, at most
  std::string_view name;   // requirement id and sentence for a person
  bool locks = false;      // leads to Lock, not to Trip
};

// Limits are in thresholds.hpp; the times are those of the safety concept (C0 budget 10 ms in all).
inline constexpr std::array<HazardFacts, kHazards> kHazardTable{{
    {Hazard::ResidualCharge, StopCategory::C0Off, 200, "R-01 voltage remains after switching off", true},
    {Hazard::NeedleNotBack, StopCategory::C0Off, 500, "R-02 needle did not return at zero volts", true},
    {Hazard::EStop, StopCategory::C0Off, 1, "R-03 emergency stop pressed"},
    {Hazard::EStopDisagrees, StopCategory::C0Off, 21, "R-04 emergency stop channels disagree"},
    {Hazard::ClockJump, StopCategory::C0Off, 1, "R-05 clock jumped or stood still"},
    {Hazard::OverVoltage, StopCategory::C0Off, 2, "R-06 high voltage above its limit"},
    {Hazard::Arc, StopCategory::C0Off, 5, "R-07 current above what the capacitance explains: arc"},
    {Hazard::MonitorDisagrees, StopCategory::C0Off, 4, "R-08 voltage monitor disagrees with the command"},
    {Hazard::DriverDisobeys, StopCategory::C0Off, 4, "R-09 driver does not follow the permit"},
    {Hazard::WrongAnswer, StopCategory::C0Off, 7, "R-10 driver answers the challenge wrongly or not at all"},
    {Hazard::SecondWriter, StopCategory::C0Off, 1, "R-11 not exactly one writer of requests and permits"},
    // A controller that died is a drive without a loop: the gate would only hold its last amplitude.
    {Hazard::ControllerSilent, StopCategory::C0Off, 4, "R-25 no new request from the controller"},
    {Hazard::PlanChanged, StopCategory::C0Off, 1, "R-12 plan is missing or is not the sealed one"},
    {Hazard::ConfigChanged, StopCategory::C0Off, 1, "R-13 configuration is not the one at start"},
    {Hazard::HardOverDepth, StopCategory::C0Off, 2, "R-14 needle beyond the plan and its margin"},
    {Hazard::FastDrop, StopCategory::C0Off, 16, "R-15 needle fell back: drive lost"},
    {Hazard::OverDepth, StopCategory::C1Ramp, 2, "R-16 needle would pass the planned depth"},
    {Hazard::PopThrough, StopCategory::C1Ramp, 10, "R-17 needle broke through a boundary"},
    {Hazard::SensorStale, StopCategory::C1Ramp, 4, "R-18 no new measurement"},
    {Hazard::SensorFrozen, StopCategory::C1Ramp, 20, "R-19 depth sensor frozen while the voltage moves"},
    {Hazard::LaserDropout, StopCategory::C1Ramp, 3, "R-20 depth sensor has no target"},
    {Hazard::OffsetOrScale, StopCategory::C1Ramp, 50, "R-21 depth is not plausible at this voltage"},
    {Hazard::PolarityStuck, StopCategory::C1Ramp, 1500, "R-22 polarity is unbalanced: charge builds up"},
    {Hazard::WrongFrequency, StopCategory::C1Ramp, 1300, "R-23 polarity changes at the wrong rate"},
    {Hazard::LoopOverrun, StopCategory::C1Ramp, 4, "R-24 control loop missed three periods"},
    {Hazard::MessageOrder, StopCategory::C1Ramp, 3, "R-26 messages lost, repeated or out of order"},
    {Hazard::WrongTissueModel, StopCategory::C1Ramp, 1100, "R-27 tissue keeps behaving unlike the plan"},
    {Hazard::LogBacklog, StopCategory::C1Ramp, 1, "R-28 procedure log cannot be written"},
    {Hazard::PlanImplausible, StopCategory::C1Ramp, 1, "R-29 plan is outside what the robot can do (units?)"},
    {Hazard::PlanUnconfirmed, StopCategory::C1Ramp, 1, "R-30 plan lacks its two confirmations"},
    {Hazard::StageDepth, StopCategory::C2Hold, 2, "R-31 needle would pass the depth of its stage"},
    {Hazard::SuspectTissueModel, StopCategory::C2Hold, 100, "R-32 tissue behaves unlike the plan"},
    {Hazard::PatientMotion, StopCategory::C2Hold, 1, "R-33 patient moved"},
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
constexpr std::string_view name_of(Hazard hazard) {
  return hazard < Hazard::None ? kHazardTable[static_cast<std::size_t>(hazard)].name : "none";
}

}  // namespace biopsy::safety
