// The tick of the driver: no memory is taken, not even where something fails.
#include <gtest/gtest.h>

#include "tests/drivers/contract/driven_stage.hpp"
#include "tests/drivers/nidaqmx/stage_in_hand.hpp"
#include "tests/robot/live/realtime/counting_allocator.hpp"

namespace biopsy::nidaqmx {
namespace {

std::uint64_t allocated_in_ticks(DrivenStage& driven) {
  const realtime::AllocationCount count;
  driven.hold(3'000'000, 100);
  return count.so_far();
}

TEST(NidaqmxTick, TakesNoMemory) {
  fake_reset();
  const realtime::AllocationCount count;
  NidaqmxStage stage(laboratory(), fake_now_us);
  EXPECT_GT(count.so_far(), 0U) << "nobody counts";
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
