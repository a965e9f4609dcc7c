// A needle stage in the laboratory: what its driver offers besides reading and writing.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "drivers/needle_stage.hpp"

namespace biopsy::drivers {

// Keys and emergency stop on the device. Default-constructed: keys off and stop pressed; what is not known
// allows nothing.
struct Panel {
  bool arm = false, reset = false;
  bool estop_a_closed = false, estop_b_closed = false;  // both closed: not pressed
  bool relay_closed = false;                            // feedback contact of the interlock
  bool read = false;                                    // all of it, in the last read() of the stage
};

// The newest error of the driver. Of fixed size: it is filled within the tick.
struct DeviceError {
  std::int32_t status = 0;  // the driver's own code
  std::uint32_t count = 0;  // errors so far
  std::array<char, 2048> text{};
};

class HardwareNeedleStage : public NeedleStage {
 public:
  virtual const std::string& product() const = 0;  // "USB-6211"
  virtual std::uint32_t serial() const = 0;
  virtual bool has_panel() const = 0;
  virtual bool has_relay_contact() const = 0;
  virtual Panel panel() const = 0;   // of the last read()
  virtual bool stopped() const = 0;  // for good: 0 V only, and the interlock gets no pulse
  virtual const DeviceError& last_error() const = 0;
  // Commissioning stops the pulse to the interlock on purpose, to see it open.
  virtual void feed_interlock(bool feeding) = 0;
};

}  // namespace biopsy::drivers
