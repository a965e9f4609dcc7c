// Everything the supervisor sees in a tick.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "robot/msg/fixed_messages.hpp"

namespace biopsy::safety {

// Default-constructed it proves nothing: unknown counts as bad.
struct Observation {
  std::int64_t now_us = 0;   // supervisor's own monotonic clock
  Measurement measurement;   // newest from the stage; seq 0 = none yet, the same seq again = none arrived
  DriveRequest request;      // newest from the controller; seq 0 = none yet
  Permit permit;             // what the supervisor issued in the last tick
  std::int32_t writers = 0;  // most writers seen on any single-writer topic; exactly 1 is right
  bool estop_a_closed = false, estop_b_closed = false;  // both closed = not pressed
  bool acquiring = true;                                // the scanner is taking an image
  std::int32_t log_backlog_ms =
      std::numeric_limits<std::int32_t>::max();  // age of the oldest unwritten record
  std::int32_t patient_motion_um = std::numeric_limits<std::int32_t>::max();   // since the plan was sealed
  std::int32_t tissue_residual_um = std::numeric_limits<std::int32_t>::max();  // |depth - the model's depth|
  std::uint64_t plan_tag = 0, config_tag = 0;    // as recomputed from what is in use now
  std::array<std::uint64_t, 2> confirmed_tag{};  // plan tags that two separate confirmations were given for
  bool bench_confirmed = false;                  // somebody at the stage says: no patient, no needle
};

}  // namespace biopsy::safety
