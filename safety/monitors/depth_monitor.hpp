// Monitors the needle (over-depth, pop-through, fast drop, no return), the brake that holds it for an image,
// and the plausibility of the depth sensor.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "safety/monitors/link_monitor.hpp"
#include "safety/types/hazards.hpp"
#include "safety/types/plan_facts.hpp"
#include "safety/types/supervisor_inputs.hpp"
#include "safety/types/thresholds.hpp"

namespace biopsy::safety {

// Depths of the last ticks with two running sums of eight: the velocity is the difference of their means, so
// that laser noise of 10 um leaves 0.6 mm/s on it. Lags by 8 ms.
struct DepthHistory {
  static constexpr std::int32_t kSpan_ticks = 10;  // over which a break-through is judged
  std::array<std::int32_t, 32> depth_um{};
  std::uint32_t next = 0;
  std::int32_t newest = 0, before = 0;  // sums of samples 0-7 and 8-15 back

  void fill(std::int32_t depth);
  void push(std::int32_t depth);
  std::int64_t velocity_um_per_s() const { return std::int64_t{newest - before} * 125 / 8; }
  std::int32_t latest_um() const { return depth_um[(next - 1) % 32]; }
  std::int32_t mean_um() const { return newest / 8; }
  std::int32_t surely_um() const {  // reached by both of the last two samples: one may be a spike
    return std::min(latest_um(), depth_um[(next - 2) % 32]);
  }
  std::int32_t advance_um() const { return latest_um() - depth_um[(next - 1 - kSpan_ticks) % 32]; }
};

// Smallest and largest |V| of the last 500 ms, in blocks of 50 ms, so that dynamics do not look like a wrong
// sensor.
struct DriveWindow {
  static constexpr std::int32_t kBlock_ticks = 50, kBlocks = 10;
  std::array<std::int32_t, kBlocks> low_mV{}, high_mV{};
  std::int32_t block = 0, ticks = 0;
  std::int32_t past_low_mV = 0, past_high_mV = 0;  // over the finished blocks
  void push(std::int32_t drive_mV);
  std::int32_t lowest_mV() const;
  std::int32_t highest_mV() const;
};

struct DepthMonitor {
  HazardSet found = 0;  // of the depth; stands until the next valid one
  bool needle_home = false, needle_back = false;
  DepthHistory history;
  DriveWindow window;
  DepthRange range;  // plausible at range_low/high_mV, to look it up only on change
  std::int32_t range_low_mV = -1, range_high_mV = -1;
  std::uint64_t range_tag = 0;
  std::int32_t dropout_score = kDropoutTrip;  // nothing seen yet
  std::int32_t over_ticks = 0, hard_ticks = 0, step_ticks = 0, pop_ticks = 0, implausible_ticks = 0;
  std::int32_t not_back_ticks = 0;
  std::int32_t deepest_um = 0, sunk_ticks = 0;      // since the needle was last free to sink
  std::int32_t lowered_mV = 0, creeping_ticks = 0;  // the drive after it was lowered; left of its creep
  std::int32_t advanced_um = 0, idle_ticks = 0;     // deepest depth seen, to kAdvanced_um
  std::int64_t pull_V2 = 0, rest_pull_V2 = 0;       // |V|^2 there; without any motion
  std::int32_t locked_um = 0, locked_ms = 0;        // where and for how long the brake has held the needle
  std::int32_t slip_ticks = 0;
  std::int32_t settling_ticks = 0;  // left since the brake let go of the needle
  std::int32_t code = 0, same_code_ticks = 0, frozen_low_mV = 0, frozen_high_mV = 0;
};

struct DepthFindings {
  HazardSet found = 0;
  bool needle_home = false, needle_back = false;
  bool locked = false;  // by the brake
  bool still = false;   // and where it was when the brake took it, for no longer than kLockedMax_ms
};

// `elapsed_ms`: as the link monitor counted them; `zero_volts`: as the drive monitor found it in this tick.
DepthFindings update(const PlanFacts& plan, DepthMonitor& monitor, const SupervisorInputs& seen,
                     const LinkFindings& link, bool zero_volts);

}  // namespace biopsy::safety
