// Ports of the commissioning steps: a rig that drives the stage under the supervisor, and the operator at the
// bench. Implemented in robot/bench; no voltage is made here.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drivers/needle_stage.hpp"

namespace biopsy::commissioning {

// One tick of 1 ms.
struct Sample {
  drivers::SensorReading reading;
  std::int32_t command_mV = 0;  // on the converter when this was read
  bool has_contacts = false;    // the emergency stop is wired to this device
  bool estop_a_closed = true, estop_b_closed = true;
  std::int64_t late_us = 0;  // start of the tick, after it was due
  std::int64_t work_us = 0;  // duration of reading and writing
};

struct Drive {
  std::vector<Sample> samples;  // from the first at the level to the last before rest
  std::string stopped_because;  // empty: ran to its end
};

class Rig {
 public:
  virtual ~Rig() = default;

  // One tick with the output off.
  virtual Sample rest() = 0;
  // Under supervisor and gate: from rest to the level (0.5 kV at most), there for `ticks` or until `go_on` is
  // false, and back to rest.
  virtual Drive drive(std::int32_t level_mV, std::uint32_t ticks,
                      const std::function<bool(const Sample&)>& go_on) = 0;
  // Whether the driver feeds its half of the external interlock. Default: true.
  virtual void feed_interlock(bool feeding) = 0;
  // Whether the supervisor feeds its half. Default: true.
  virtual void feed_supervisors_half(bool feeding) = 0;
};

// What the operator does by hand.
enum class Act : std::uint8_t { Prepare, LayBlock, RemoveBlock, PressEstopUnderVoltage, ReleaseEstop };

class Operator {
 public:
  virtual ~Operator() = default;
  virtual void notify(const std::string& what) = 0;
  virtual bool confirm(Act act, const std::string& what) = 0;              // false: not done
  virtual std::optional<double> enter_value(const std::string& what) = 0;  // none: no usable number
};

}  // namespace biopsy::commissioning
