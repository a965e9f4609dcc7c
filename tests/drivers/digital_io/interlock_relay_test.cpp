// The relay on a virtual clock.
#include "drivers/digital_io/interlock_relay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>

#include "tests/drivers/digital_io/high_voltage.hpp"
#include "tests/robot/live/realtime/counting_allocator.hpp"
#include "tests/safety/verifies.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::digital_io {
namespace {

constexpr std::int64_t kMillisecond_ns = 1'000'000;
constexpr std::int64_t kTick_ns = kMillisecond_ns / 2;
constexpr std::int64_t kLate_ns = kTick_ns;  // how late a tick may be
constexpr std::int64_t kPulseLimit_ns = 20 * kMillisecond_ns;

// A stage at +6 kV, a supervisor and the relay between them.
class Relay : public testing::Test {
 protected:
  Relay() : reader_((create_shared_io(folder_.path()), folder_.path())) {
    stage_.emplace(folder_.path());
    supervisor_.emplace(folder_.path());
    relay_.emplace(folder_.path(), now_);
    stage_->write(high_voltage(6'000'000));
  }

  void tick() { relay_->tick(now_ += kTick_ns); }
  void feed_both() { stage_->pulse(), supervisor_->pulse(); }
  void close() {
    feed_both();
    tick();
    ASSERT_TRUE(relay_->closed());
  }
  std::int32_t load_mV() const { return reader_.relay().output.load_mV; }

  ScratchFolder folder_;
  IoReader reader_;
  std::optional<StageIo> stage_;
  std::optional<SupervisorIo> supervisor_;
  std::optional<InterlockRelay> relay_;
  std::int64_t now_ = 500 * kMillisecond_ns;
};

TEST_F(Relay, IsOpenUntilBothHavePulsed) {
  EXPECT_FALSE(relay_->closed());
  tick();
  EXPECT_FALSE(relay_->closed()) << "a level is no pulse";
  stage_->pulse();
  tick();
  EXPECT_FALSE(relay_->closed());
  EXPECT_EQ(load_mV(), 0);
  supervisor_->pulse();
  tick();
  EXPECT_TRUE(relay_->closed());
  EXPECT_EQ(load_mV(), 6'000'000);
}

TEST_F(Relay, OpensWithinTwentyMillisecondsOfTheLastPulseOfEither) {
  verifies("R-43");
  for (const bool stage_stops : {false, true})
    for (std::int64_t phase_ns = 0; phase_ns < kTick_ns; phase_ns += 12'500) {
      close();
      // The last pulse of the one that stops comes `phase_ns` after a tick of the relay.
      const std::int64_t last_pulse = now_ + phase_ns;
      feed_both();
      for (int i = 0; i < 100 && relay_->closed(); ++i) {
        tick();
        stage_stops ? supervisor_->pulse() : stage_->pulse();
      }
      EXPECT_LE(now_ + kTick_ns + kLate_ns - last_pulse, kPulseLimit_ns)
          << "even if the next tick, a late one, were the first to show it";
      EXPECT_GE(now_ + 2 * kTick_ns + kLate_ns - last_pulse, kPulseLimit_ns)
          << "no sooner than the relay can know";
      EXPECT_EQ(load_mV(), 0);
      EXPECT_EQ(reader_.relay().zero_ns, now_);
      EXPECT_EQ(reader_.converter().mV, 6'000'000) << "the converter still holds its value";
    }
}

TEST_F(Relay, OpensInTimeWithATickThatIsLate) {
  verifies("R-43");
  std::mt19937 random(5);
  std::uniform_int_distribution<std::int64_t> late(0, kLate_ns), phase(0, kTick_ns - 1);
  for (int trial = 0; trial < 2'000; ++trial) {
    close();
    const std::int64_t last_pulse = now_ + phase(random);
    feed_both();
    std::int64_t due = now_;
    while (relay_->closed()) relay_->tick(now_ = (due += kTick_ns) + late(random));
    ASSERT_LE(now_ - last_pulse, kPulseLimit_ns) << trial;
    now_ = due;
  }
}

TEST_F(Relay, StaysClosedWhileBothAreWithinTheirTimeAndOnlyThen) {
  std::mt19937 random(11);
  std::uniform_int_distribution<std::int64_t> pause(0, 60);  // relay periods; 40 are the limit
  std::int64_t stage_at = 0, supervisor_at = 0, next_stage = 0, next_supervisor = 0, closed = 0;
  constexpr std::int64_t kTicks = 100'000;
  for (std::int64_t i = 0; i < kTicks; ++i) {
    if (i >= next_stage) stage_->pulse(), stage_at = now_, next_stage = i + 1 + pause(random);
    if (i >= next_supervisor)
      supervisor_->pulse(), supervisor_at = now_, next_supervisor = i + 1 + pause(random);
    tick();
    const std::int64_t oldest = now_ - std::min(stage_at, supervisor_at);
    ASSERT_EQ(relay_->closed(), oldest + kTick_ns + kLate_ns < kPulseLimit_ns)
        << "tick " << i << ", last pulse " << oldest << " ns ago";
    closed += relay_->closed() ? 1 : 0;
  }
  EXPECT_GT(closed, kTicks / 4);
  EXPECT_LT(closed, kTicks);
}

TEST_F(Relay, GivesTheLoadTheConvertersVoltageWhileClosed) {
  close();
  feed_both();
  stage_->write(high_voltage(-3'000'000));
  tick();
  EXPECT_EQ(load_mV(), -3'000'000);
  EXPECT_EQ(reader_.relay().changed_ns, now_);
  stage_->write(safety::GatedVoltage::off());
  tick();
  EXPECT_TRUE(relay_->closed());
  EXPECT_EQ(load_mV(), 0);
  EXPECT_EQ(reader_.relay().zero_ns, now_);
}

TEST_F(Relay, StartsOpenAndDoesNotCountEarlierPulses) {
  for (const bool stage_feeds : {false, true}) {
    close();
    relay_.reset();
    feed_both();
    relay_.emplace(folder_.path(), now_ += kMillisecond_ns);
    EXPECT_EQ(load_mV(), 0) << "open before its first tick";
    for (int i = 0; i < 100; ++i) {
      stage_feeds ? stage_->pulse() : supervisor_->pulse();
      tick();
      ASSERT_FALSE(relay_->closed());
    }
  }
  close();
}

TEST_F(Relay, GivesTheLoadNothingWhileHvIsOff) {
  stage_.reset();
  const OwnOutputs<StageOutputs> broken_stage(folder_.path());
  broken_stage->converter = packed(6'000'000, false);
  broken_stage->pulses = 1'000;
  supervisor_->pulse();
  tick();
  EXPECT_TRUE(relay_->closed());
  EXPECT_EQ(load_mV(), 0);
  EXPECT_EQ(reader_.load_voltage_seen_mV(now_), 0);
}

TEST_F(Relay, DoesNotTakeAPulseBeforeItsStallForANewOne) {
  close();
  feed_both();  // the last pulses; the relay stalls for a second
  relay_->tick(now_ += 1'000 * kMillisecond_ns);
  EXPECT_FALSE(relay_->closed());
  for (int i = 0; i < 100; ++i) {
    tick();
    EXPECT_FALSE(relay_->closed());
  }
}

TEST_F(Relay, OpensWhenItsClockGoesBackAndOnCommand) {
  close();
  feed_both();
  relay_->tick(now_ - 10 * kMillisecond_ns);
  EXPECT_FALSE(relay_->closed());
  close();
  relay_->open(now_);
  EXPECT_FALSE(relay_->closed());
  EXPECT_EQ(load_mV(), 0);
  tick();
  EXPECT_FALSE(relay_->closed()) << "earlier pulses do not count";
}

TEST_F(Relay, CountsAsOpenForReadersMoreThanTwentyMillisecondsFromItsLastTick) {
  close();
  for (const auto& [after_ns, seen_mV] : {std::pair{std::int64_t{0}, 6'000'000},
                                          {kPulseLimit_ns - 1, 6'000'000},
                                          {kPulseLimit_ns, 0},
                                          {1'000 * kPulseLimit_ns, 0},
                                          {std::int64_t{-1'000}, 6'000'000},
                                          {-kPulseLimit_ns, 0}})
    EXPECT_EQ(reader_.load_voltage_seen_mV(now_ + after_ns), seen_mV) << after_ns << " ns";
  EXPECT_EQ(load_mV(), 6'000'000) << "its last output, which no longer counts";
  stage_->write(high_voltage(1'000'000));
  EXPECT_EQ(reader_.load_voltage_seen_mV(now_), 1'000'000) << "the converter's present value, without a tick";
}

TEST_F(Relay, AllocatesNothingNorDoItsPulsesAndReaders) {
  PanelIo panel(folder_.path());
  const safety::GatedVoltage voltage = high_voltage(1'000'000);
  const realtime::AllocationCount count;
  std::int64_t sum_mV = 0;
  for (int i = 0; i < 100; ++i) {
    feed_both();
    stage_->write(voltage);
    panel.set(reader_.panel(now_).levels);
    tick();
    sum_mV += reader_.load_voltage_seen_mV(now_);
  }
  EXPECT_EQ(count.so_far(), 0U);
  EXPECT_EQ(sum_mV, 100 * 1'000'000);
}

TEST_F(Relay, KeepsItsTimesToTheMicrosecond) {
  const auto after_opening = [&](std::int64_t after_ns) {
    relay_->open(now_);
    feed_both();
    relay_->tick(now_ += after_ns);  // the pulses are as old as the opening
    return relay_->closed();
  };
  EXPECT_TRUE(after_opening(18'999'000));
  EXPECT_FALSE(after_opening(19'000'000));
  const auto after_tick = [&](std::int64_t after_ns) {
    close();
    const std::int64_t fed_ns = now_ - kTick_ns;
    relay_->tick(now_ = fed_ns + after_ns);
    return relay_->closed();
  };
  EXPECT_TRUE(after_tick(18'999'000));
  EXPECT_FALSE(after_tick(19'000'000));
}

TEST_F(Relay, NotesWhenTheLoadBecameZeroAndNotWhenItChangedOtherwise) {
  close();
  const std::int64_t zero_ns = reader_.relay().zero_ns;
  feed_both();
  stage_->write(high_voltage(2'000'000));
  tick();
  EXPECT_EQ(reader_.relay().changed_ns, now_);
  EXPECT_EQ(reader_.relay().zero_ns, zero_ns);
}

}  // namespace
}  // namespace biopsy::digital_io
