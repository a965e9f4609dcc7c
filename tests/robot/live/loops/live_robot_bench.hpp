// The operator's side of the live robot on a fake bus, its thread a turn at a time.
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>

#include "robot/live/session/live_robot.hpp"
#include "tests/robot/live/loops/bench.hpp"

namespace biopsy::loops_tests {

// Lets the robot's thread take one turn at a time.
class Turns {
 public:
  void arrive() {
    std::unique_lock lock(mutex_);
    ++arrived_;
    changed_.notify_all();
    changed_.wait(lock, [this] { return free_ || let_ >= arrived_; });
  }
  void one() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return arrived_ > let_; });
    ++let_;
    changed_.notify_all();
    changed_.wait(lock, [this] { return arrived_ > let_; });
  }
  void release() {
    const std::scoped_lock lock(mutex_);
    free_ = true;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int arrived_ = 0, let_ = 0;
  bool free_ = false;
};

struct LiveRobotBench : LoopBench {
  LiveRobotBench() {
    fake_bus::state().on_wait = [this](auto) { turns.arrive(); };
    robot.emplace(bus, folder.path(), kConfig);
  }
  ~LiveRobotBench() override {
    turns.release();
    robot.reset();
  }
  void put_measurement() {
    Measurement measured;
    measured.seq = ++seq;
    fake_bus::put(measured);
  }
  // The operator's program asks for `inputs`, then the thread takes a turn, `us` after the start.
  std::optional<robot::CycleSample> ask(const robot::OperatorInputs& inputs, std::int64_t us) {
    fake_bus::set_clock_us(kStart_us + us);
    put_measurement();
    if (seq == 1) put_measurement();
    turns.one();
    fake_bus::set_clock_us(kStart_us + us);
    std::optional<robot::CycleSample> sample = robot->tick(inputs);
    turns.one();
    return sample;
  }
  void turn(std::int64_t us) {
    fake_bus::set_clock_us(kStart_us + us);
    turns.one();
  }
  static robot::OperatorInputs asked() {
    robot::OperatorInputs inputs = robot::OperatorInputs::idle();
    inputs.press = {41, true};
    return inputs;
  }

  Turns turns;
  std::optional<robot::LiveRobot> robot;
  std::uint32_t seq = 0;
};

}  // namespace biopsy::loops_tests
