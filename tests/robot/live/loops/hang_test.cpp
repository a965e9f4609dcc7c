// Only the thread of one loop hangs; bus, clock, interlock and the other loop go on. The real relay and the
// real digital I/O, on virtual time: the pulses of the loop that hangs must end, and with them high voltage.
#include <condition_variable>
#include <thread>

#include "drivers/digital_io/interlock_relay.hpp"
#include "drivers/digital_io/shared_io.hpp"
#include "robot/live/stage_loop.hpp"
#include "robot/live/supervisor_loop.hpp"
#include "tests/drivers/digital_io/high_voltage.hpp"
#include "tests/robot/live/loops/bench.hpp"

namespace biopsy::loops_tests {
namespace {

// A gate through which a thread passes, or at which it hangs.
class Barrier {
 public:
  void pass() {
    std::unique_lock lock(mutex_);
    waiting_ = closed_;
    changed_.notify_all();
    changed_.wait(lock, [this] { return !closed_; });
    waiting_ = false;
  }
  void close() {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
  }
  void await_hang() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return waiting_; });
  }
  void open() {
    const std::scoped_lock lock(mutex_);
    closed_ = false;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool closed_ = false, waiting_ = false;
};

struct HangingStage final : drivers::NeedleStage {
  Barrier& barrier;
  explicit HangingStage(Barrier& at) : barrier(at) {}
  drivers::SensorReading read() override {
    barrier.pass();
    return {};
  }
  std::int32_t write(const safety::GatedVoltage& voltage) override { return voltage.mV(); }
};

struct Hang : LoopBench {
  Hang() {
    calls.output.interlock_pulse = true;
    relay.emplace(folder.path(), now_us * 1'000);
    converter.write(digital_io::high_voltage(6'000'000));
  }
  void tick_relay() {
    now_us += 1'000;
    relay->tick(now_us * 1'000);
  }
  bool supplied() const { return reader.is_supplied(now_us * 1'000); }
  void tick_supervisor() {
    fake_bus::set_clock_us(now_us);
    Measurement measured;
    measured.seq = ++seq;
    fake_bus::put(measured);
    supervisor.turn();
  }
  // Everything else goes on for 30 ms; says for how many of them there was high voltage, ms.
  template <class Others>
  int supplied_for_ms(const Others& others) {
    int ms = 0;
    for (int n = 0; n < 30; ++n) {
      fake_bus::put(fields::distinct<Permit>(n));
      fake_bus::put(fields::distinct<DriveRequest>(n));
      others();
      tick_relay();
      ms += supplied() ? 1 : 0;
    }
    return ms;
  }

  std::int64_t now_us = kStart_us;
  std::uint32_t seq = 0;
  digital_io::StageIo converter{folder.path()};
  digital_io::SupervisorIo pulse{folder.path()};
  const digital_io::IoReader reader{folder.path()};
  std::optional<digital_io::InterlockRelay> relay;
  Barrier barrier;
  HangingStage stage{barrier};
  live::StageLoop stage_loop{bus, stage, converter, kConfig};
  live::FilesTag files;
  live::SupervisorLoop supervisor{bus, pulse, reader, files, kConfig, 1, safety::SelfTest::Passed, false};
};

TEST_F(Hang, OfTheStagesLoopAloneTakesHighVoltageAwayWithinTwentyMilliseconds) {
  for (int n = 0; n < 30; ++n) {
    stage_loop.tick(now_us);
    tick_supervisor();
    tick_relay();
  }
  ASSERT_TRUE(supplied());
  barrier.close();
  std::thread hangs([this] { stage_loop.tick(now_us); });  // in the driver, where a board may keep it
  barrier.await_hang();
  const std::uint64_t pulses = reader.stage_pulses();
  const int ms = supplied_for_ms([this] { tick_supervisor(); });
  EXPECT_EQ(reader.stage_pulses(), pulses) << "a pulse that no tick gave";
  EXPECT_LE(ms, 20);
  EXPECT_FALSE(supplied());
  barrier.open();
  hangs.join();
}

TEST_F(Hang, OfTheSupervisorsLoopAloneTakesHighVoltageAwayWithinTwentyMilliseconds) {
  for (int n = 0; n < 30; ++n) {
    stage_loop.tick(now_us);
    tick_supervisor();
    tick_relay();
  }
  ASSERT_TRUE(supplied());
  Barrier in_the_bus;
  in_the_bus.close();
  fake_bus::state().on_wait = [&](auto) { in_the_bus.pass(); };
  std::thread hangs([this] { supervisor.turn(); });
  in_the_bus.await_hang();
  const std::uint64_t pulses = reader.supervisor_pulses();
  fake_bus::written<Permit>();
  const int ms = supplied_for_ms([this] { stage_loop.tick(now_us); });
  EXPECT_EQ(reader.supervisor_pulses(), pulses) << "a pulse that no turn gave";
  EXPECT_TRUE(fake_bus::written<Permit>().empty()) << "a permit that no turn gave";
  EXPECT_LE(ms, 20);
  EXPECT_FALSE(supplied());
  in_the_bus.open();
  hangs.join();
}

}  // namespace
}  // namespace biopsy::loops_tests
