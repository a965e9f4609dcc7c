// A stage behind the electrical lines: what the gate gives goes on the converter's line, and the simulated
// stack gets it only through the interlock's relay.
#pragma once

#include <cstdint>

#include "drivers/digital_io/io_views.hpp"
#include "drivers/needle_stage.hpp"
#include "sim/simulated_stage.hpp"

namespace biopsy::app {

// Real time: one write() is as many milliseconds of the plant as went by since the last.
class WiredSimStage final : public port::NeedleStage {
 public:
  WiredSimStage(sim::SimStage& stage, lines::StageLines& lines, const lines::LinesReader& relay)
      : stage_(stage), lines_(lines), relay_(relay) {}

  port::SensorReading read() override;
  void write(const safety::GatedVoltage& voltage) override;

 private:
  sim::SimStage& stage_;
  lines::StageLines& lines_;
  const lines::LinesReader& relay_;
  std::int64_t written_ns_ = 0;
};

// A real stage: its converter drives the amplifier itself, the line only shows what was written.
class WiredRealStage final : public port::NeedleStage {
 public:
  WiredRealStage(port::NeedleStage& stage, lines::StageLines& lines) : stage_(stage), lines_(lines) {}

  port::SensorReading read() override { return stage_.read(); }
  void write(const safety::GatedVoltage& voltage) override {
    stage_.write(voltage);
    lines_.write(voltage);
  }

 private:
  port::NeedleStage& stage_;
  lines::StageLines& lines_;
};

}  // namespace biopsy::app
