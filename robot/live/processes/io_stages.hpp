// Needle stages of the stage process, coupled to the simulated digital I/O that all processes share.
#pragma once

#include <cstdint>

#include "drivers/digital_io/io_views.hpp"
#include "drivers/hardware_needle_stage.hpp"
#include "drivers/needle_stage.hpp"

namespace biopsy::robot {

// Keys and contacts of a hardware stage as the supervisor reads them. It has no key for the bench.
digital_io::PanelLevels panel_levels(const drivers::Panel& panel);

// The simulated stage in real time: one write() advances the plant by the milliseconds that went by since the
// last. Its converter is the shared output; stack and brake get what the interlock's relay lets through.
class SimulatedNeedleStage final : public drivers::NeedleStage {
 public:
  // `stage`: the plant, or what stands between it and its sensors.
  SimulatedNeedleStage(drivers::NeedleStage& stage, digital_io::StageIo& io,
                       const digital_io::IoReader& relay)
      : stage_(stage), io_(io), relay_(relay) {}

  drivers::SensorReading read() override;
  std::int32_t write(const safety::GatedVoltage& voltage) override;

 private:
  drivers::NeedleStage& stage_;
  digital_io::StageIo& io_;
  const digital_io::IoReader& relay_;
  std::int64_t written_ns_ = 0;
};

// A hardware stage: its converter drives the amplifier itself, the shared output shows what was written.
class MirroredNeedleStage final : public drivers::NeedleStage {
 public:
  MirroredNeedleStage(drivers::NeedleStage& stage, digital_io::StageIo& io) : stage_(stage), io_(io) {}

  drivers::SensorReading read() override { return stage_.read(); }
  std::int32_t write(const safety::GatedVoltage& voltage) override {
    io_.write(voltage);
    return stage_.write(voltage);
  }

 private:
  drivers::NeedleStage& stage_;
  digital_io::StageIo& io_;
};

}  // namespace biopsy::robot
