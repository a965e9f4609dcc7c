// A line to the external interlock: a timer that keeps the high voltage on for 20 ms after the last change of
// the line's level (safety concept: one fed by the driver, one by the supervisor, in series).
#pragma once

namespace biopsy::drivers {

class PulseOutput {
 public:
  virtual ~PulseOutput() = default;

  // Toggles the level. Neither throws nor blocks for more than a tick; a line that failed keeps its level,
  // and the timer expires.
  virtual void pulse() = 0;
  virtual bool failed() const { return false; }  // for good
};

}  // namespace biopsy::drivers
