// The person at the panel of a simulated device: tests it once in each session of the supervisor, as a person
// does on hardware. Presses the emergency stop, releases it and turns the reset key.
#pragma once

#include <cstdint>

#include "drivers/digital_io/io_block.hpp"

namespace biopsy::robot {

class PanelTest {
 public:
  // What the contacts show at `now_us`: during the test the person's hand, otherwise `asked`. `session`: of
  // the supervisor's last decision; 0: none yet.
  digital_io::PanelLevels levels(digital_io::PanelLevels asked, std::uint32_t session, std::int64_t now_us) {
    if (session == 0) return asked;
    if (session != session_) session_ = session, began_us_ = now_us;
    const std::int64_t since_us = now_us - began_us_;
    if (since_us >= kEnd_us) return asked;
    const bool pressed = since_us >= kPress_us && since_us < kRelease_us;
    const bool turned = since_us >= kTurn_us && since_us < kLetGo_us;
    return {.reset_key = turned, .estop_a_closed = !pressed, .estop_b_closed = !pressed};
  }

 private:
  static constexpr std::int64_t kPress_us = 100'000, kRelease_us = 200'000, kTurn_us = 300'000,
                                kLetGo_us = 400'000, kEnd_us = 450'000;
  std::uint32_t session_ = 0;
  std::int64_t began_us_ = 0;
};

}  // namespace biopsy::robot
