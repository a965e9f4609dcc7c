// Every hard limit of the robot, each with its reason. Constants of the build: no file can change them.
#pragma once

#include <cstdint>

namespace biopsy::limits {

// Voltage
// ---------------------------------------------------------------------------------------------------------
inline constexpr std::int32_t kDriveMax_mV = 8'000'000;  // paper IV.C: characterised up to 8 kV
inline constexpr std::int32_t kMonitorTrip_mV =
    8'200'000;  // safety concept: over-voltage, 2.5 % above the drive limit
inline constexpr std::int32_t kZeroVolt_mV =
    100'000;  // below this the stack exerts no force that lifts (P < 15 Pa)
inline constexpr std::int32_t kSlewUpMax_mV_per_tick =
    400'000;                                       // 0 -> 8 kV in 20 ms: above what PI needs, below an impact
inline constexpr std::int32_t kRampTime_ms = 300;  // C1: monitored ramp ends within this
// Depth
// -----------------------------------------------------------------------------------------------------------
inline constexpr std::int32_t kStroke_um = 12'000;  // paper IV: 11 pouches lift a loaded plate about 12 mm
inline constexpr std::int32_t kDepthMargin_um = 1'000;  // plan margin: 50 ms at 20 mm/s
inline constexpr std::int32_t kDepthHard_um = 2'000;    // never further beyond the plan than this
inline constexpr std::int32_t kReturned_um = 1'000;     // needle counts as withdrawn below this depth
// And is back below this: only then a plan for a patient becomes ready.
inline constexpr std::int32_t kBack_um = 100;
inline constexpr std::int32_t kStill_um = 100;  // an image may be blurred by so much: a tenth of a voxel
// Time
// ------------------------------------------------------------------------------------------------------------
inline constexpr std::int32_t kPermitTtl_us = 5'000;  // five missed permits end the permission
inline constexpr std::int32_t kHoldMax_ms = 10'000;   // DC drifts: a hold is not a place to stay
// Locked by the brake and without voltage nothing drifts: a scan of a minute, once more, and time to think.
inline constexpr std::int32_t kLockedMax_ms = 180'000;
inline constexpr std::int32_t kArmedMax_ms = 30'000;  // without a press the arming expires

}  // namespace biopsy::limits
