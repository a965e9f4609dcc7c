// What the steps of commissioning need: a stage that somebody drives for them under the supervisor, and a
// operator at the bench. Both are other people's business (robot); a voltage is never made here.
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
  bool has_contacts = false;    // of the emergency stop, on this device
  bool estop_a_closed = true, estop_b_closed = true;
  std::int64_t late_us = 0;  // the tick began so long after it was due
  std::int64_t work_us = 0;  // what reading and writing took
};

struct Drive {
  std::vector<Sample> samples;  // from the first at the level to the last before rest
  std::string stopped_because;  // empty: nothing but the end of what was asked
};

class Rig {
 public:
  virtual ~Rig() = default;

  // With the output off.
  virtual Sample rest() = 0;
  // Under supervisor and gate: from rest to the level, there for up to so many ticks as long as `go_on` says
  // so, and back to rest. At most 0.5 kV.
  virtual Drive drive(std::int32_t level_mV, std::uint32_t ticks,
                      const std::function<bool(const Sample&)>& go_on) = 0;
  // Whether the driver feeds the external interlock; it does unless told otherwise.
  virtual void feed_interlock(bool feeding) = 0;
  // Whether the supervisor feeds its half of it; likewise.
  virtual void feed_supervisors_half(bool feeding) = 0;
};

// What an operator is asked to do with their hands.
enum class Act : std::uint8_t { Prepare, LayBlock, RemoveBlock, PressEstopUnderVoltage, ReleaseEstop };

class Operator {
 public:
  virtual ~Operator() = default;
  virtual void notify(const std::string& what) = 0;
  virtual bool confirm(Act act, const std::string& what) = 0;              // false: not done
  virtual std::optional<double> enter_value(const std::string& what) = 0;  // a number; none: nothing usable
};

}  // namespace biopsy::commissioning
