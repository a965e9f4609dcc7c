// Monitors the links: clocks, sequence numbers, challenge answers, writers, log, the sealed plan
// and its confirmations.
#pragma once

#include <array>
#include <cstdint>

#include "safety/types/hazards.hpp"
#include "safety/types/plan_facts.hpp"
#include "safety/types/supervisor_inputs.hpp"
#include "safety/types/thresholds.hpp"

namespace biopsy::safety {

struct LinkMonitor {
  bool clock_read = false;
  std::int64_t now_us = 0, counted_us = 0;  // of the last tick, and up to which milliseconds were counted
  // measurements
  std::uint32_t seq = 0;
  std::int64_t stage_us = 0;
  std::int32_t stale_ticks = kStale_ticks + 1;  // nothing seen yet
  std::int32_t order_score = 0;
  // challenge
  std::uint32_t answered_seq = 0;
  std::int32_t answer_score = kScoreMax;  // nothing proven yet
  std::array<Mode, 8> permit_mode{};      // of the last permits, by seq modulo 8
  // controller
  std::uint32_t request_seq = 0;
  std::int32_t silent_ticks = kStale_ticks + 1;
  std::uint32_t overruns = 0;
  std::int32_t miss_score = 0;
  // tissue, plan
  std::int32_t residual_ticks = 0;
  bool plan_plausible = false;
};

struct LinkFindings {
  HazardSet found = 0;
  bool fresh = false;           // the measurement is new and may be used
  std::int32_t elapsed_ms = 1;  // on the supervisor's clock since the last tick
};

LinkFindings update(const PlanFacts& plan, LinkMonitor& monitor, const SupervisorInputs& seen);

}  // namespace biopsy::safety
