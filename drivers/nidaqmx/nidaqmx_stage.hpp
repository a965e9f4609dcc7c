// The needle stage in the laboratory: laser, amplifier and interlock on an NI board (USB-6211), read and
// written on demand, once a tick. Nothing in the tick allocates, logs or throws.
//
// Errors. A reading that is late repeats the last one with laser_valid false, and the interlock gets no pulse
// in that tick (three in a row: laser dropout, C1). A voltage that could not be written, a board that is gone
// or a fault stops the stage for good: it writes 0 V only, gives no pulse, and time_us stands still, which
// the supervisor takes for a broken clock (C0).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "drivers/hardware_needle_stage.hpp"
#include "drivers/nidaqmx/config.hpp"
#include "drivers/nidaqmx/task.hpp"

namespace biopsy::nidaqmx {

std::int64_t monotonic_us();

class NidaqmxStage final : public drivers::HardwareNeedleStage {
 public:
  using Clock = std::int64_t (*)();

  // Resets the board (its converter then stands at 0 V), tests it and takes its channels. Throws ConfigError.
  explicit NidaqmxStage(Config config, Clock clock = monotonic_us);
  // Leaves the converter, which holds its last value, at 0 V.
  ~NidaqmxStage() override;
  NidaqmxStage(const NidaqmxStage&) = delete;
  NidaqmxStage& operator=(const NidaqmxStage&) = delete;

  drivers::SensorReading read() override;
  std::int32_t write(const safety::GatedVoltage& voltage) override;

  const std::string& product() const override { return product_; }
  std::uint32_t serial() const override { return serial_; }
  bool has_panel() const override { return panel_task_.has_value(); }
  bool has_relay_contact() const override { return config_.relay_contact.has_value(); }
  drivers::Panel panel() const override { return panel_; }
  bool stopped() const override { return stopped_; }
  const drivers::DeviceError& last_error() const override { return error_; }
  void feed_interlock(bool feeding) override { feeding_ = feeding; }

 private:
  void find_board();
  void connect();
  bool is_good(Status status);  // keeps an error in error_
  bool read_voltages();
  bool read_panel();
  void write_lines(bool enabled, bool pulse, bool brake);
  void stop_for_good() { stopped_ = true; }

  Config config_;
  Clock clock_;
  DaqmxFunctions daqmx_;
  std::string product_;
  std::uint32_t serial_ = 0;
  std::optional<Task> inputs_, output_, lines_task_, panel_task_;

  std::array<double, 5> volts_{};  // as analog_inputs()
  drivers::SensorReading reading_;
  drivers::Panel panel_;
  drivers::DeviceError error_;
  std::uint32_t lines_ = 0;  // written last
  bool fresh_ = false;       // this tick's sensors were read
  bool feeding_ = true;
  bool stopped_ = false;
};

}  // namespace biopsy::nidaqmx
