// Distance of the needle from the depths that the plan's tissue explains:
// SupervisorInputs::tissue_residual_um.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include "robot/msg/fixed_messages.hpp"
#include "safety/types/limits.hpp"
#include "safety/types/plan_facts.hpp"

namespace biopsy::safety {

inline constexpr std::int32_t kMean_ticks = 512;  // about one period of the square wave

// Mean |V| over about half a second, to which the depth corresponds without ripple. Default: no drive yet.
struct TissueMonitor {
  std::int32_t mean_drive_mV = 0;
};

// um, never negative. To be called once for each new measurement.
inline std::int32_t tissue_residual_um(const PlanFacts& plan, TissueMonitor& monitor,
                                       const Measurement& measured) {
  const std::int32_t drive_mV = std::clamp(measured.command_mV, -limits::kDriveMax_mV, limits::kDriveMax_mV);
  const std::int32_t depth_um =
      std::clamp(measured.depth_um, -1'000'000, 1'000'000);  // no sensor reaches a metre
  monitor.mean_drive_mV += (std::abs(drive_mV) - monitor.mean_drive_mV) / kMean_ticks;
  if (measured.brake_on) return 0;  // the drive says nothing about a locked needle
  const DepthRange range = plausible_depth(plan, monitor.mean_drive_mV, monitor.mean_drive_mV);
  return std::max({range.low_um - depth_um, depth_um - range.high_um, 0});
}

}  // namespace biopsy::safety
