// The hardware stage, ready to be driven: its driver, verified against its commissioning record.
#pragma once

#include <filesystem>
#include <memory>

#include "drivers/hardware_needle_stage.hpp"
#include "robot/common/units.hpp"
#include "robot/live/realtime/tick_clock.hpp"

namespace biopsy::robot {

// `device`: its name. Throws ConfigError where the device, its configuration, its commissioning record or its
// panel is missing or wrong.
std::unique_ptr<drivers::HardwareNeedleStage> open_commissioned_stage(
    const std::string& device, const std::filesystem::path& config,
    const std::filesystem::path& commissioning, const std::filesystem::path& public_key);

// For loops that run as fast as they can: each read() waits for its millisecond.
class RealtimeNeedleStage final : public drivers::NeedleStage {
 public:
  explicit RealtimeNeedleStage(drivers::NeedleStage& stage) : stage_(stage), clock_(kTick) {}

  drivers::SensorReading read() override {
    clock_.wait();
    return stage_.read();
  }
  std::int32_t write(const safety::GatedVoltage& voltage) override { return stage_.write(voltage); }

 private:
  drivers::NeedleStage& stage_;
  realtime::TickClock clock_;
};

}  // namespace biopsy::robot
