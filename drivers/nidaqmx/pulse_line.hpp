// The supervisor's pulse to its half of the external interlock: one output line of a board of its own, so
// that a failure of the stage's board does not affect it.
#pragma once

#include <cstdint>
#include <string>

#include "drivers/nidaqmx/config.hpp"
#include "drivers/nidaqmx/task.hpp"
#include "drivers/pulse_output.hpp"

namespace biopsy::nidaqmx {

class PulseLine final : public drivers::PulseOutput {
 public:
  // Opens the line of `[supervisor_pulse]` and sets it low. Throws ConfigError where the configuration has
  // none or the board refuses.
  explicit PulseLine(const Config& config);
  ~PulseLine() override;  // low

  void pulse() override;
  bool failed() const override { return failed_; }

 private:
  SupervisorPulse wired_;
  double timeout_s_;
  DaqmxFunctions daqmx_;
  std::string name_;
  Task task_;
  bool high_ = false, failed_ = false;
};

}  // namespace biopsy::nidaqmx
