#include "tests/robot/live/processes/fake_machine.hpp"

#include <utility>

#include "drivers/needle_stage_factory.hpp"
#include "robot/common/config_error.hpp"
#include "robot/cycle/self_test.hpp"
#include "robot/live/realtime/tick_clock.hpp"
#include "tests/robot/live/loops/fake_bus.hpp"

namespace biopsy::fake_machine {
namespace {

class FakeStage final : public drivers::HardwareNeedleStage {
 public:
  drivers::SensorReading read() override {
    fake_bus::state().now_ns += std::exchange(state().board.stands_ns, 0);
    return {.time_us = 1, .depth_um = 321};
  }
  std::int32_t write(const safety::GatedVoltage& voltage) override {
    state().board.written_mV.push_back(voltage.mV());
    return voltage.mV();
  }
  const std::string& product() const override { return product_; }
  std::uint32_t serial() const override { return 4'711; }
  bool has_panel() const override { return state().board.has_panel; }
  bool has_relay_contact() const override { return state().board.has_relay_contact; }
  drivers::Panel panel() const override { return state().board.panel; }
  bool stopped() const override { return false; }
  const drivers::DeviceError& last_error() const override { return state().board.error; }
  void feed_interlock(bool) override {}

 private:
  std::string product_ = "USB-6211";
};

struct FakePulse final : drivers::PulseOutput {
  void pulse() override { ++state().board.pulses; }
  bool failed() const override { return state().board.pulse_failed; }
};

}  // namespace

State& state() {
  static State one;
  return one;
}

}  // namespace biopsy::fake_machine

namespace biopsy::realtime {

using fake_machine::state;

RealtimeObtained become_realtime(const RealtimeSettings& settings) {
  state().asked.push_back(settings);
  return state().granted;
}

std::string to_text(const RealtimeObtained&) {
  return "as granted, " + std::to_string(state().asked.size());
}

Wake TickSchedule::woke(std::int64_t now_ns) {
  const Wake wake{due_ns_, now_ns, state().missed};
  due_ns_ += (1 + wake.missed) * period_ns_;
  return wake;
}

TickClock::TickClock(std::chrono::nanoseconds period)
    : schedule_(fake_bus::state().now_ns + period.count(), period.count()) {
  state().periods.push_back(period);
}

Wake TickClock::wait() {
  state().late_ns = state().missed = 0;
  ++state().ticks;
  if (state().on_tick) state().on_tick(state().ticks);
  fake_bus::state().now_ns = schedule_.due_ns() + state().late_ns;
  const Wake wake = schedule_.woke(fake_bus::state().now_ns);
  missed_ += wake.missed;
  return wake;
}

}  // namespace biopsy::realtime

namespace biopsy::robot {

safety::SelfTest self_test(const TestedFunctions&) {
  return fake_machine::state().self_test;
}

}  // namespace biopsy::robot

namespace biopsy::drivers {

std::unique_ptr<HardwareNeedleStage> make_hardware_stage(const std::string& device,
                                                         const std::filesystem::path& config) {
  fake_machine::state().board.opened.push_back("stage " + device + " " + config.filename().string());
  return std::make_unique<fake_machine::FakeStage>();
}

std::unique_ptr<PulseOutput> make_supervisor_pulse(const std::string& device,
                                                   const std::filesystem::path& config) {
  fake_machine::state().board.opened.push_back("pulse " + device + " " + config.filename().string());
  return std::make_unique<fake_machine::FakePulse>();
}

}  // namespace biopsy::drivers

namespace biopsy::commissioning {

Record load_commissioning(const std::filesystem::path& folder, const std::filesystem::path& public_key,
                          const Device& device, const std::string& config_sha256,
                          std::chrono::system_clock::time_point now) {
  fake_machine::state().loaded.push_back({folder, public_key, device, config_sha256, now});
  if (const auto& wrong = fake_machine::state().record_is_wrong)
    throw ConfigError(*wrong, folder.string(), "commission it");
  return {};
}

}  // namespace biopsy::commissioning
