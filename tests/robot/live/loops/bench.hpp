// A loop at rest on a fake bus: what every test of the loops begins with.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <iterator>

#include "drivers/digital_io/io_views.hpp"
#include "robot/transport/bus.hpp"
#include "tests/robot/live/loops/fake_bus.hpp"
#include "tests/robot/live/loops/fake_cycle.hpp"
#include "tests/robot/live/loops/fields.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::loops_tests {

constexpr std::int64_t kStart_us = 50'000'000;
constexpr std::uint64_t kConfig = 0x1122334455667788;

struct LoopBench : testing::Test {
  LoopBench() {
    fake_bus::reset(kStart_us);
    fake_cycle::calls() = {};
    digital_io::create_shared_io(folder.path());
  }

  // Threads of this process: a loop has none of its own, so that nothing outlives it.
  static std::ptrdiff_t threads() {
    return std::distance(std::filesystem::directory_iterator("/proc/self/task"), {});
  }

  const ScratchFolder folder;
  const transport::Participant bus{transport::BusSettings{}};
  fake_cycle::Calls& calls = fake_cycle::calls();
};

}  // namespace biopsy::loops_tests
