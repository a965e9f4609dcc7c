// What the stage's loop carries from bus and clock to gate and interlock, and back. Inputs: messages in which
// each field has a value of its own.
#include "robot/live/stage_loop.hpp"

#include "drivers/digital_io/shared_io.hpp"
#include "tests/robot/live/loops/bench.hpp"

namespace biopsy::loops_tests {
namespace {

struct DepthOnly final : drivers::NeedleStage {
  std::int32_t depth_um = 17;
  std::size_t driven = 0;  // times before the last reading
  drivers::SensorReading read() override {
    driven = fake_cycle::calls().driven.size();
    drivers::SensorReading reading;
    reading.depth_um = depth_um;
    return reading;
  }
  std::int32_t write(const safety::GatedVoltage& voltage) override { return voltage.mV(); }
};

struct StageLoopBench : LoopBench {
  void tick() { loop.tick(now_us += 1'000); }
  std::uint64_t pulses() const { return reader.stage_pulses(); }

  DepthOnly stage;
  digital_io::StageIo lines{folder.path()};
  const digital_io::IoReader reader{folder.path()};
  live::StageLoop loop{bus, stage, lines, kConfig};
  std::int64_t now_us = kStart_us;
};

TEST_F(StageLoopBench, GivesTheGateEveryFieldOfPermitAndRequestItsOwnClockAndTheWriters) {
  fields::for_each_field(fields::distinct<Permit>(100), [&](auto, const Permit& permit) {
    fake_bus::put(permit);
    tick();
    EXPECT_EQ(calls.driven.back().permit, permit);
  });
  const Permit last = *calls.driven.back().permit;
  fields::for_each_field(fields::distinct<DriveRequest>(200), [&](auto, const DriveRequest& request) {
    fake_bus::put(request);
    tick();
    EXPECT_EQ(calls.driven.back().request, request);
    EXPECT_EQ(calls.driven.back().permit, last) << "the newest stays until another comes";
  });
  EXPECT_EQ(calls.driven.back().now_us, now_us);
  EXPECT_EQ(calls.driven.back().writers, 1);
}

TEST_F(StageLoopBench, GivesTheGateNothingBeforeAMessageCame) {
  tick();
  EXPECT_FALSE(calls.driven.back().permit);
  EXPECT_FALSE(calls.driven.back().request);
}

TEST_F(StageLoopBench, TakesTheNewestOfMany) {
  for (std::uint32_t seq = 1; seq <= 3; ++seq) {
    Permit permit;
    permit.seq = seq;
    DriveRequest request;
    request.seq = 10 + seq;
    fake_bus::put(permit);
    fake_bus::put(request);
  }
  tick();
  EXPECT_EQ(calls.driven.back().permit->seq, 3U);
  EXPECT_EQ(calls.driven.back().request->seq, 13U);
}

TEST_F(StageLoopBench, TellsTheGateOfAnyNumberOfWritersButOneOfEach) {
  for (const auto& [permits, requests, told] :
       {std::array{1, 1, 1}, {0, 1, 0}, {1, 0, 0}, {2, 1, 2}, {1, 2, 2}, {0, 2, 0}, {3, 1, 3}, {2, 0, 2}}) {
    fake_bus::channel<Permit>().writers = permits;
    fake_bus::channel<DriveRequest>().writers = requests;
    tick();
    EXPECT_EQ(calls.driven.back().writers, told) << permits << " of permits, " << requests << " of requests";
  }
}

TEST_F(StageLoopBench, PulsesOnceATickWhereTheGateFeedsTheInterlockAndNoThreadOfItsOwnDoes) {
  const std::ptrdiff_t before = threads();
  for (int n = 1; n <= 50; ++n) {
    const std::uint64_t had = pulses();
    calls.feeds_interlock = n % 3 != 0;
    tick();
    EXPECT_EQ(pulses() - had, n % 3 != 0 ? 1U : 0U);
  }
  EXPECT_EQ(threads(), before);
}

// Who may pulse is the gate's to say.
TEST_F(StageLoopBench, PulsesAsTheGateSaysWhateverElseIsWrong) {
  fake_bus::channel<Permit>().writers = 2;
  for (const bool feeds : {true, false}) {
    const std::uint64_t had = pulses();
    calls.feeds_interlock = feeds;
    tick();
    EXPECT_EQ(pulses() - had, feeds ? 1U : 0U);
  }
}

TEST_F(StageLoopBench, PublishesOneMeasurementATickReadAfterTheGate) {
  for (std::uint32_t n = 1; n <= 5; ++n) {
    stage.depth_um = 1'000 * static_cast<std::int32_t>(n);
    tick();
    const std::vector<Measurement> sent = fake_bus::written<Measurement>();
    ASSERT_EQ(sent.size(), 1U);
    EXPECT_EQ(sent.front().seq, n);
    EXPECT_EQ(sent.front().depth_um, stage.depth_um);
    EXPECT_EQ(stage.driven, n) << "of this tick";
    EXPECT_EQ(sent.front().config_tag, kConfig);
    EXPECT_EQ(loop.measured(), sent.front());
  }
}

TEST_F(StageLoopBench, SwitchesOffWithoutAnyPermitRequestOrWriter) {
  fake_bus::put(fields::distinct<Permit>(1));
  fake_bus::put(fields::distinct<DriveRequest>(1));
  tick();
  loop.switch_off(now_us + 7);
  EXPECT_FALSE(calls.driven.back().permit);
  EXPECT_FALSE(calls.driven.back().request);
  EXPECT_EQ(calls.driven.back().writers, 0);
  EXPECT_EQ(calls.driven.back().now_us, now_us + 7);
}

TEST_F(StageLoopBench, SaysThatItIsReadyWithItsNameAndConfigurationTenTimesASecond) {
  fake_bus::state().unauthenticated = 5;
  loop.heartbeat().lateness().record(123'000);
  std::size_t sent = 0;
  Health last;
  for (int n = 0; n < 1'000; ++n) {
    tick();
    for (const Health& health : fake_bus::written<Health>()) last = health, ++sent;
  }
  EXPECT_EQ(sent, 10U);
  EXPECT_EQ(last.process, Process::Stage);
  EXPECT_EQ(last.config_tag, kConfig);
  EXPECT_EQ(last.seq, 10U);
  EXPECT_TRUE(last.ready);
  EXPECT_EQ(last.refused, 5U);
  EXPECT_EQ(last.late_max_us, 123);
}

}  // namespace
}  // namespace biopsy::loops_tests
