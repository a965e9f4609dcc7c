// The person at the panel of a simulated device: proves it once in each session of the supervisor, as a
// person does on hardware. Presses the emergency stop, releases it and turns the reset key; once more where
// that did not count, or where the turn of the key did not release the stop.
#pragma once

#include <cstdint>

#include "drivers/digital_io/io_layout.hpp"
#include "robot/msg/messages.hpp"
#include "safety/types/hazards.hpp"

namespace biopsy::robot {

class PanelProof {
 public:
  // What the contacts show at `now_us`: during the proof the person's hand, otherwise `asked`; a stop that is
  // asked for is pressed in any case. `told`: the supervisor's last decision; session 0: none yet.
  digital_io::PanelLevels levels(digital_io::PanelLevels asked, const Decision& told, std::int64_t now_us) {
    if (told.session == 0) return asked;
    if (told.session != session_) {
      session_ = told.session, began_us_ = now_us, released_ = false;
    } else if (now_us - began_us_ >= kEnd_us) {
      // Once the supervisor has seen the stop released, a stop that it finds is somebody's, or its panel's.
      const bool stop = told.worst == static_cast<std::uint8_t>(safety::Hazard::EStop);
      const bool untested = told.worst == static_cast<std::uint8_t>(safety::Hazard::PanelUntested);
      released_ = released_ || !stop;
      if (untested || (stop && !released_)) began_us_ = now_us;
    }
    const std::int64_t since_us = now_us - began_us_;
    if (since_us >= kLetGo_us) return asked;
    const bool pressed = since_us >= kPress_us && since_us < kRelease_us;
    return {.reset_key = since_us >= kTurn_us,
            .estop_a_closed = !pressed && asked.estop_a_closed,
            .estop_b_closed = !pressed && asked.estop_b_closed};
  }

 private:
  // kEnd_us: the supervisor has told what it made of it.
  static constexpr std::int64_t kPress_us = 100'000, kRelease_us = 200'000, kTurn_us = 300'000,
                                kLetGo_us = 400'000, kEnd_us = 600'000;
  std::uint32_t session_ = 0;
  std::int64_t began_us_ = 0;
  bool released_ = false;  // after the proof of this session
};

}  // namespace biopsy::robot
