// The needle stage in the laboratory: laser, amplifier and interlock on an NI board (USB-6211), read and
// written on demand, once a tick. Nothing in the tick allocates, logs or throws.
//
// What is not known is said by what every stage says. A reading that did not come in time repeats the last
// one with laser_valid false and leaves the interlock unfed for that tick (three of them: laser dropout, C1).
// A voltage that could not be written, a board that is gone or a fault stops the stage for good: from then on
// it writes 0 V only and feeds no interlock, and time_us stands still, a broken clock for the supervisor
// (C0).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "drivers/needle_stage.hpp"
#include "drivers/nidaqmx/config.hpp"
#include "drivers/nidaqmx/task.hpp"

namespace biopsy::nidaqmx {

std::int64_t monotonic_us();

// Default-constructed: keys up and buttons pressed; what is not known allows nothing.
struct Panel {
  bool arm = false, reset = false;
  bool estop_a_closed = false, estop_b_closed = false;
};

class NidaqmxStage final : public drivers::NeedleStage {
 public:
  using Clock = std::int64_t (*)();

  // Resets the board (its converter then stands at 0 V), tests it and takes its channels. Throws ConfigError.
  explicit NidaqmxStage(Config config, Clock clock = monotonic_us);
  // The converter holds its last value when nobody writes: leaves it at 0 V.
  ~NidaqmxStage() override;
  NidaqmxStage(const NidaqmxStage&) = delete;
  NidaqmxStage& operator=(const NidaqmxStage&) = delete;

  drivers::SensorReading read() override;
  void write(const safety::GatedVoltage& voltage) override;

  const std::string& product() const { return product_; }  // "USB-6211"
  std::uint32_t serial() const { return serial_; }
  bool has_panel() const { return panel_task_.has_value(); }
  Panel panel() const { return panel_; }  // of the last read()
  bool stopped() const { return stopped_; }
  const TroubleNote& trouble() const { return trouble_; }  // newest, for the log

  // Commissioning stops the pulse on purpose, to see the interlock open.
  void feed_interlock(bool feeding) { feeding_ = feeding; }

 private:
  void find_board();
  void connect();
  bool is_good(Status status);  // notes what is not
  bool read_voltages();
  bool read_panel();
  void write_lines(bool enabled, bool pulse);
  void stop_for_good() { stopped_ = true; }

  Config config_;
  Clock clock_;
  DaqmxFunctions daqmx_;
  std::string product_;
  std::uint32_t serial_ = 0;
  std::optional<Task> inputs_, output_, lines_task_, panel_task_;

  std::array<double, 3> volts_{};  // laser, voltage, current
  drivers::SensorReading reading_;
  Panel panel_;
  TroubleNote trouble_;
  std::uint32_t lines_ = 0;  // written last
  bool fresh_ = false;       // this tick's sensors were read
  bool feeding_ = true;
  bool stopped_ = false;
};

}  // namespace biopsy::nidaqmx
