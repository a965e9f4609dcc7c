// What happens to the high voltage when a process of the live robot dies or stands still, or their network
// loses packets: real processes, a real procedure, the person's finger staying on the button.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "robot/live/session/live_options.hpp"
#include "robot/msg/messages.hpp"
#include "robot/procedure/case/prepared_case.hpp"
#include "tests/robot/live/bad_wire.hpp"

namespace biopsy::live_tests {

struct LiveEvent {
  Process victim = Process::Stage;
  int signal = 0;                // SIGKILL or SIGSTOP; 0: none, packets are lost instead
  std::int64_t after_ticks = 0;  // of motion
  PacketTrouble packets = {};    // from the event on
};

struct EventOutcome {
  std::string trouble;        // empty: the event took place while high voltage was on
  double to_zero_ms = -1.0;   // from the event to the last volt on the stack; < 0: it stayed on
  double host_late_ms = 0.0;  // the worst wake of a 2 kHz real-time clock on this machine between the two
  // Longest that voltage stood on the stack since the supervisor's last pulse, which it gives while it
  // permits
  double unpermitted_ms = 0.0;
  PacketTrouble packets;  // that really happened
};

// Starts a robot in `folder`, moves the needle, sends the signal and watches the lines for `watch_ms`.
EventOutcome live_event(const LiveEvent& event, const robot::LiveOptions& options,
                        const robot::PreparedCase& prepared, const std::filesystem::path& folder,
                        std::int64_t watch_ms);

}  // namespace biopsy::live_tests
