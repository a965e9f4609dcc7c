// All inputs of the supervisor in a tick: one struct, filled in one place (robot/cycle). Every default is the
// value that allows least: unknown counts as bad.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "robot/msg/fixed_messages.hpp"

namespace biopsy::safety {

inline constexpr std::int32_t kUnknown = std::numeric_limits<std::int32_t>::max();

enum class SelfTest : std::uint8_t { Failed, Pending, Passed };

// Hold-to-run. While the button is down the console sends {token, held = true} at least every
// kHeldTimeout_ms; each press has a token larger than every one before. {token, false} is the release;
// token 0 = no message this tick.
struct MotionPress {
  std::uint32_t token = 0;
  bool held = false;
};

struct SupervisorInputs {
  std::int64_t now_us = 0;  // supervisor's own monotonic clock
  SelfTest self_test = SelfTest::Pending;

  // Stage and controller
  Measurement measurement;  // newest from the stage; seq 0 = none yet, the same seq again = none arrived
  DriveRequest request;     // newest from the controller; seq 0 = none yet
  Permit permit;            // what the supervisor issued in the last tick

  // Links
  std::int32_t writers = 0;                // most writers seen on any single-writer topic; exactly 1 is right
  std::int32_t log_backlog_ms = kUnknown;  // age of the oldest record that is not on disk
  std::uint64_t plan_tag = 0, config_tag = 0;  // as recomputed from what is in use now

  // Panel on the device: levels, as safety/monitors/panel_filter.hpp passes them. The supervisor takes the
  // rising edges of the keys.
  bool panel_read = false;    // within the last kPanelRead_us; unread counts as the emergency stop pressed
  bool relay_closed = false;  // feedback contact of the interlock
  bool estop_a_closed = false, estop_b_closed = false;  // both closed = not pressed
  bool local_arm = false, local_reset = false;
  bool bench_confirmed = false;  // the person at the stage confirms: no patient, no needle

  // Operator, over the network
  StopCategory stop = StopCategory::C0Off;  // the strongest stop that anybody requests
  MotionPress motion;
  bool remote_arm = false, remote_reset = false;  // always refused, with a reason
  std::array<std::uint64_t, 2> confirmed_tag{};   // plan tags that two separate confirmations were given for
  bool depth_accepted = false;                    // level: the depth check of `accepted_step` says Accept
  std::uint32_t accepted_step = 0;
  std::uint32_t accepted_session = 0,
                accepted_since_seq = 0;  // of the permit when its image began to be taken

  // Patient and scanner
  bool acquiring = true;                       // the scanner is taking an image
  std::int32_t patient_motion_um = kUnknown;   // since the plan was sealed
  std::int32_t tissue_residual_um = kUnknown;  // |depth - the model's depth|
};

}  // namespace biopsy::safety
