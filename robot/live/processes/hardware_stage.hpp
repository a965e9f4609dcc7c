// The hardware stage, ready to be driven: its driver, verified against its commissioning record.
#pragma once

#include <filesystem>
#include <memory>

#include "drivers/needle_stage.hpp"
#include "drivers/nidaqmx/nidaqmx_stage.hpp"
#include "robot/common/units.hpp"
#include "robot/live/realtime/tick_clock.hpp"

namespace biopsy::robot {

// Throws ConfigError where the board, its configuration, its commissioning record or its keys are not as they
// must be.
std::unique_ptr<nidaqmx::NidaqmxStage> commissioned_stage(const std::filesystem::path& config,
                                                          const std::filesystem::path& commissioning,
                                                          const std::filesystem::path& public_key);

// A real stage for loops that run as fast as they can: each tick waits for its millisecond.
class RealtimeNeedleStage final : public drivers::NeedleStage {
 public:
  explicit RealtimeNeedleStage(drivers::NeedleStage& stage) : stage_(stage), clock_(kTick) {}

  drivers::SensorReading read() override {
    clock_.wait();
    return stage_.read();
  }
  void write(const safety::GatedVoltage& voltage) override { stage_.write(voltage); }

 private:
  drivers::NeedleStage& stage_;
  realtime::TickClock clock_;
};

}  // namespace biopsy::robot
