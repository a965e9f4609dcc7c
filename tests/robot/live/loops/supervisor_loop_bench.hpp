// The supervisor's loop over a bus, a cycle and a clock that are the test's own.
#pragma once

#include "drivers/digital_io/shared_io.hpp"
#include "robot/live/supervisor_loop.hpp"
#include "tests/robot/live/loops/bench.hpp"

namespace biopsy::loops_tests {

inline constexpr std::uint32_t kSession = 31;

struct CountedPulse final : drivers::PulseOutput {
  int pulses = 0;
  void pulse() override { ++pulses; }
};

struct SupervisorLoopBench : LoopBench {
  // One turn at a time `us` after the start, with a measurement.
  void turn(std::int64_t us) {
    fake_bus::set_clock_us(kStart_us + us);
    Measurement measured;
    measured.seq = ++seq;
    fake_bus::put(measured);
    loop.turn();
  }
  const robot::SupervisorSources& last() const { return calls.supervised.back(); }

  digital_io::PanelIo panel_of_device{folder.path()};
  const digital_io::IoReader panel{folder.path()};
  CountedPulse pulse;
  live::FilesTag files;
  live::SupervisorLoop loop{bus, pulse, panel, files, kConfig, kSession, safety::SelfTest::Passed, false};
  std::uint32_t seq = 0;
};

}  // namespace biopsy::loops_tests
