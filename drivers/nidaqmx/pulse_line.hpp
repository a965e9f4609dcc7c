// The supervisor's pulse to its half of the external interlock: one output line, on a board that is not the
// stage's. So it fails with the supervisor and not with the driver it guards.
#pragma once

#include <cstdint>
#include <string>

#include "drivers/nidaqmx/config.hpp"
#include "drivers/nidaqmx/task.hpp"
#include "drivers/pulse_output.hpp"

namespace biopsy::nidaqmx {

class PulseLine final : public drivers::PulseOutput {
 public:
  // Takes the line of `[supervisor_pulse]` and puts it low. Throws ConfigError where the configuration has
  // none or the board does not give it.
  explicit PulseLine(const Config& config);
  ~PulseLine() override;  // low

  void pulse() override;
  bool failed() const { return failed_; }  // for good: the board said no once

 private:
  SupervisorPulse wired_;
  double timeout_s_;
  DaqmxFunctions daqmx_;
  std::string name_;
  Task task_;
  bool high_ = false, failed_ = false;
};

}  // namespace biopsy::nidaqmx
