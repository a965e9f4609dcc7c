// The tick of the driver: no memory is taken, not even where something fails.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "tests/contract/driven_stage.hpp"
#include "tests/nidaqmx/stage_in_hand.hpp"

namespace {
std::size_t allocations = 0;
}

void* operator new(std::size_t size) {
  ++allocations;
  if (void* const memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace biopsy::nidaqmx {
namespace {

std::size_t allocated_in_ticks(DrivenStage& driven) {
  const std::size_t before = allocations;
  driven.hold(3'000'000, 100);
  return allocations - before;
}

TEST(NidaqmxTick, TakesNoMemory) {
  fake_reset();
  NidaqmxStage stage(laboratory(), fake_now_us);
  EXPECT_GT(allocations, 0U) << "nobody counts";
  DrivenStage driven(stage);
  EXPECT_EQ(allocated_in_ticks(driven), 0U);
}

TEST(NidaqmxTick, TakesNoMemoryForItsTroublesEither) {
  for (const Status status : {-200284, -201003, -200088}) {
    fake_reset();
    NidaqmxStage stage(laboratory(), fake_now_us);
    DrivenStage driven(stage);
    fake_fail("DAQmxReadAnalogF64", status, -1);
    EXPECT_EQ(allocated_in_ticks(driven), 0U) << status;
    EXPECT_GT(stage.trouble().count, 0U);
  }
}

}  // namespace
}  // namespace biopsy::nidaqmx
