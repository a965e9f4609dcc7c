// A stage behind the digital I/O: the gated voltage goes to the converter, and to the simulated stack only
// through the interlock's relay.
#pragma once

#include <cstdint>

#include "drivers/digital_io/io_views.hpp"
#include "drivers/needle_stage.hpp"
#include "sim/simulated_stage.hpp"

namespace biopsy::robot {

// In real time: a write() advances the plant by the milliseconds since the last.
class SimulatedNeedleStage final : public drivers::NeedleStage {
 public:
  SimulatedNeedleStage(sim::SimulatedStage& stage, digital_io::StageIo& lines,
                       const digital_io::IoReader& relay)
      : stage_(stage), lines_(lines), relay_(relay) {}

  drivers::SensorReading read() override;
  void write(const safety::GatedVoltage& voltage) override;

 private:
  sim::SimulatedStage& stage_;
  digital_io::StageIo& lines_;
  const digital_io::IoReader& relay_;
  std::int64_t written_ns_ = 0;
};

// A hardware stage drives the amplifier itself; the digital I/O only mirrors what was written.
class HardwareNeedleStage final : public drivers::NeedleStage {
 public:
  HardwareNeedleStage(drivers::NeedleStage& stage, digital_io::StageIo& lines)
      : stage_(stage), lines_(lines) {}

  drivers::SensorReading read() override { return stage_.read(); }
  void write(const safety::GatedVoltage& voltage) override {
    stage_.write(voltage);
    lines_.write(voltage);
  }

 private:
  drivers::NeedleStage& stage_;
  digital_io::StageIo& lines_;
};

}  // namespace biopsy::robot
