#include "robot/live/processes/io_stages.hpp"

#include <algorithm>
#include <chrono>

#include "robot/common/units.hpp"
#include "robot/live/realtime/tick_clock.hpp"

namespace biopsy::robot {
namespace {

constexpr std::int64_t kTick_ns = std::chrono::nanoseconds(kTick).count();
constexpr std::int64_t kCatchUp_ticks = 50;  // after a longer stall the rest of its time is left out

}  // namespace

digital_io::PanelLevels panel_levels(const drivers::Panel& panel) {
  return {.arm_key = panel.arm,
          .reset_key = panel.reset,
          .estop_a_closed = panel.estop_a_closed,
          .estop_b_closed = panel.estop_b_closed,
          .bench_key = false,
          .relay_closed = panel.relay_closed,
          .relay_wired = true};
}

drivers::SensorReading SimulatedNeedleStage::read() {
  drivers::SensorReading reading = stage_.read();
  reading.time_us = realtime::monotonic_ns() / 1000;
  return reading;
}

std::int32_t SimulatedNeedleStage::write(const safety::GatedVoltage& voltage) {
  io_.write(voltage);
  const std::int64_t now_ns = realtime::monotonic_ns();
  const std::int64_t elapsed = written_ns_ == 0 ? 1 : (now_ns - written_ns_ + kTick_ns / 2) / kTick_ns;
  const std::int64_t ticks = std::clamp<std::int64_t>(elapsed, 0, kCatchUp_ticks);
  written_ns_ = written_ns_ == 0 || ticks == kCatchUp_ticks ? now_ns : written_ns_ + ticks * kTick_ns;
  const bool on = relay_.is_supplied(now_ns);
  for (std::int64_t tick = 0; tick < ticks; ++tick) stage_.write(on ? voltage : safety::GatedVoltage::off());
  return voltage.mV();
}

}  // namespace biopsy::robot
