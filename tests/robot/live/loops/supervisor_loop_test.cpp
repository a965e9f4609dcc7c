// What the supervisor's loop gathers for a tick, how often it ticks, and what becomes of what was decided.
#include "robot/live/supervisor_loop.hpp"

#include <chrono>

#include "tests/robot/live/loops/supervisor_loop_bench.hpp"

namespace biopsy::loops_tests {
namespace {

// A new member of the sources makes this fail to compile, until a test claims where it comes from.
void expect_same(const robot::SupervisorSources& a, const robot::SupervisorSources& b) {
  const auto& [now_us, measurement, request, writers, panel, files_tag, files_read_us, act, log, verdict,
               navigation] = a;
  EXPECT_EQ(measurement, b.measurement);
  EXPECT_EQ(request, b.request);
  EXPECT_EQ(writers, b.writers);
  EXPECT_EQ(panel.levels, b.panel.levels);
  EXPECT_EQ(panel.read, b.panel.read);
  EXPECT_EQ(files_tag, b.files_tag);
  EXPECT_EQ(files_read_us, b.files_read_us);
  EXPECT_EQ(act.message, b.act.message);
  EXPECT_EQ(log.message, b.log.message);
  EXPECT_EQ(verdict, b.verdict);
  EXPECT_EQ(act.at_us, b.act.at_us);
  EXPECT_EQ(log.at_us, b.log.at_us);
  EXPECT_EQ(navigation.message, b.navigation.message);
  EXPECT_EQ(navigation.at_us, b.navigation.at_us);
  EXPECT_NE(now_us, b.now_us) << "each tick has a time of its own";
}

// Every field of one message reaches its own place, and with it nothing else changes.
template <class Message, class Place>
void expect_carried(SupervisorLoopBench& bench, const Place& place) {
  std::int64_t us = 100'000;
  fields::for_each_field(fields::distinct<Message>(300), [&](auto, const Message& message) {
    bench.turn(us += 1'000);
    robot::SupervisorSources expected = bench.last();
    fake_bus::set_clock_us(kStart_us + (us += 1'000));
    fake_bus::put(message);
    if constexpr (!std::is_same_v<Message, Measurement>) {
      expected.measurement = {};
      expected.measurement.seq = ++bench.seq;
      fake_bus::put(expected.measurement);
    }
    place(expected, message, kStart_us + us);
    bench.loop.turn();
    expect_same(expected, bench.last());
  });
}

TEST_F(SupervisorLoopBench, CarriesEveryFieldOfEveryMessageToItsPlaceWithTheTimeThatItCame) {
  using Sources = robot::SupervisorSources;
  expect_carried<Measurement>(*this,
                              [](Sources& in, const Measurement& m, std::int64_t) { in.measurement = m; });
  expect_carried<DriveRequest>(*this,
                               [](Sources& in, const DriveRequest& m, std::int64_t) { in.request = m; });
  expect_carried<OperatorAct>(*this, [](Sources& in, const OperatorAct& m, std::int64_t us) {
    in.act = {m, us};
  });
  expect_carried<LogHealth>(*this, [](Sources& in, const LogHealth& m, std::int64_t us) {
    in.log = {m, us};
  });
  expect_carried<DepthVerdictNote>(
      *this, [](Sources& in, const DepthVerdictNote& m, std::int64_t) { in.verdict = m; });
  expect_carried<NavigationRequest>(*this, [](Sources& in, const NavigationRequest& m, std::int64_t us) {
    in.navigation = {m, us};
  });
}

// Whose sensor measures the patient is not known then: what the one said grows old.
TEST_F(SupervisorLoopBench, TakesNothingOfNavigationProgramsWhileThereAreTwo) {
  NavigationRequest request;
  request.measures_patient = true;
  request.patient_motion_um = 700;
  fake_bus::put(request);
  turn(1'000);
  for (const int writers : {2, 0}) {
    fake_bus::channel<NavigationRequest>().writers = writers;
    request.patient_motion_um = 0;
    fake_bus::put(request);
    turn(writers == 2 ? 2'000 : 3'000);
    EXPECT_EQ(last().navigation.message.patient_motion_um, 700);
    EXPECT_EQ(last().navigation.at_us, kStart_us + 1'000);
  }
  fake_bus::channel<NavigationRequest>().writers = 1;
  fake_bus::put(request);
  turn(4'000);
  EXPECT_EQ(last().navigation.message.patient_motion_um, 0);
}

TEST_F(SupervisorLoopBench, ReadsEachContactOfThePanelInTheTickItself) {
  digital_io::StageIo stage(folder.path());
  for (int wire = 0; wire < 5; ++wire) {
    const std::int64_t us = 1'000 * (2 * wire + 1);
    stage.mark_panel_read((kStart_us + us) * 1'000);
    panel_of_device.set(digital_io::panel_levels(1U << wire));
    turn(us);
    EXPECT_TRUE(last().panel.read);
    EXPECT_EQ(last().panel.levels, digital_io::panel_levels(1U << wire));
    panel_of_device.set({});
    turn(us + 1'000);
    EXPECT_EQ(last().panel.levels, digital_io::PanelLevels{});
  }
  turn(10'000'000);
  EXPECT_FALSE(last().panel.read) << "read ten seconds ago";
  EXPECT_EQ(last().panel.age_us, 10'000'000 - 9'000);
}

TEST_F(SupervisorLoopBench, CountsTheWritersOfEachTopicInItsOwnPlace) {
  const auto count = [](auto& channel, int writers, int alive) {
    channel.writers = writers, channel.alive = alive;
  };
  count(fake_bus::channel<Measurement>(), 11, 21);
  count(fake_bus::channel<DriveRequest>(), 12, 22);
  count(fake_bus::channel<OperatorAct>(), 13, 23);
  count(fake_bus::channel<SealedPlan>(), 14, 24);
  count(fake_bus::channel<DepthVerdictNote>(), 15, 25);
  count(fake_bus::channel<LogHealth>(), 16, 26);
  calls.writer_count = 9;
  turn(1'000);
  const auto& [measurements, requests, acts, measurements_alive, requests_alive, plans, verdicts, log] =
      calls.writers;
  EXPECT_EQ(measurements, 11);
  EXPECT_EQ(requests, 12);
  EXPECT_EQ(acts, 13);
  EXPECT_EQ(measurements_alive, 21);
  EXPECT_EQ(requests_alive, 22);
  EXPECT_EQ(plans, 14);
  EXPECT_EQ(verdicts, 15);
  EXPECT_EQ(log, 16);
  EXPECT_EQ(last().writers, 9);
}

TEST_F(SupervisorLoopBench, StartsWithItsConfigurationSelfTestAndSession) {
  turn(1'000);
  EXPECT_EQ(calls.supervisor_config, kConfig);
  EXPECT_EQ(calls.self_test, safety::SelfTest::Passed);
  EXPECT_EQ(calls.session, kSession);
  live::SupervisorLoop failed(bus, pulse, panel, files, kConfig, kSession, safety::SelfTest::Failed, false);
  fake_bus::put(Measurement{});
  failed.turn();
  EXPECT_EQ(calls.self_test, safety::SelfTest::Failed);
}

// What changes between two ticks of one turn: here by the pulse of the first.
TEST_F(SupervisorLoopBench, ReadsThePanelInEachTickOfABurst) {
  struct TurnsAKey final : drivers::PulseOutput {
    digital_io::PanelIo& panel;
    explicit TurnsAKey(digital_io::PanelIo& of) : panel(of) {}
    void pulse() override { panel.set({.reset_key = true}); }
  } turns_a_key(panel_of_device);
  digital_io::StageIo(folder.path()).mark_panel_read(kStart_us * 1'000);
  live::SupervisorLoop other(bus, turns_a_key, panel, files, kConfig, kSession, safety::SelfTest::Passed,
                             false);
  calls.output.interlock_pulse = true;
  for (std::uint32_t n = 1; n <= 2; ++n) {
    Measurement measured;
    measured.seq = n;
    fake_bus::put(measured);
  }
  other.turn();
  ASSERT_EQ(calls.supervised.size(), 2U);
  EXPECT_FALSE(calls.supervised[0].panel.levels.reset_key);
  EXPECT_TRUE(calls.supervised[1].panel.levels.reset_key);
}

TEST_F(SupervisorLoopBench, OpensEveryPlanThatComesAndSaysItsTag) {
  fields::for_each_field(SealedPlan{1, {1, 2}, {}, {}}, [&](auto, const SealedPlan& plan) {
    calls.plan_tag = 88 + plan.seq;
    fake_bus::put(plan);
    turn(1'000 * (1 + static_cast<std::int64_t>(calls.accepted.size())));
    EXPECT_EQ(calls.accepted.back(), plan);
    EXPECT_EQ(loop.heartbeat().health().plan_tag, calls.plan_tag);
  });
  const std::size_t opened = calls.accepted.size();
  turn(90'000);
  EXPECT_EQ(calls.accepted.size(), opened) << "once";
}

TEST_F(SupervisorLoopBench, PublishesThePermitAsDecidedAndTheDecisionOfTheSameTick) {
  fields::for_each_field(fields::distinct<Permit>(400), [&](auto, const Permit& permit) {
    calls.output.permit = permit;
    calls.panel_unread_ms = static_cast<std::int32_t>(calls.supervised.size()) - 1;
    turn(1'000 * (1 + static_cast<std::int64_t>(calls.supervised.size())));
    const std::vector<Permit> permits = fake_bus::written<Permit>();
    const std::vector<Decision> decisions = fake_bus::written<Decision>();
    ASSERT_EQ(permits.size(), 1U);
    EXPECT_EQ(permits.front(), permit);
    ASSERT_EQ(decisions.size(), 1U);
    EXPECT_EQ(decisions.front().seq, permit.seq);
    EXPECT_EQ(decisions.front().time_us, last().now_us);
    EXPECT_EQ(decisions.front().epoch, fake_cycle::kEpochOfMessage);
    EXPECT_EQ(decisions.front().panel_unread_ms, calls.panel_unread_ms);
    EXPECT_EQ(loop.mode(), permit.mode);
    const auto wall = std::chrono::system_clock::now().time_since_epoch();
    EXPECT_NEAR(static_cast<double>(decisions.front().at_ns) * 1e-9,
                std::chrono::duration<double>(wall).count(), 60.0);
  });
}

TEST_F(SupervisorLoopBench, FeedsTheInterlockInTicksThatSaySoAndNoThreadOfItsOwnDoes) {
  const std::ptrdiff_t before = threads();
  for (int n = 1; n <= 50; ++n) {
    const int had = pulse.pulses;
    calls.output.interlock_pulse = n % 3 == 0;
    turn(1'000 * n);
    EXPECT_EQ(pulse.pulses - had, n % 3 == 0 ? 1 : 0);
  }
  EXPECT_EQ(threads(), before);
}

TEST_F(SupervisorLoopBench, WithoutMeasurementsTicksAfterOneAndAHalfMillisecondsThenEveryMillisecond) {
  turn(10'000);
  const std::int64_t began_us = last().now_us;
  for (int n = 0; n < 4; ++n) loop.turn();
  std::vector<std::int64_t> after_us;
  for (const robot::SupervisorSources& in : calls.supervised)
    if (in.now_us > began_us) after_us.push_back(in.now_us - began_us);
  EXPECT_EQ(after_us, (std::vector<std::int64_t>{1'500, 2'500, 3'500, 4'500}));
  EXPECT_EQ(last().measurement.seq, 1U) << "the last that came";
}

TEST_F(SupervisorLoopBench, AMeasurementThatComesEndsTheImpatience) {
  turn(10'000);
  loop.turn();  // 1.5 ms later, without
  turn(12'400);
  const std::size_t ticks = calls.supervised.size();
  loop.turn();
  ASSERT_EQ(calls.supervised.size(), ticks + 1);
  EXPECT_EQ(last().now_us - (kStart_us + 12'400), 1'500);
}

TEST_F(SupervisorLoopBench, AWakeBeforeItsTimeIsNoTick) {
  turn(10'000);
  fake_bus::state().on_wait = [](auto) {};  // woken by nothing
  loop.turn();
  EXPECT_EQ(calls.supervised.size(), 1U);
}

TEST_F(SupervisorLoopBench, NeverWaitsForATimeThatIsOver) {
  turn(10'000);
  fake_bus::state().waited.clear();
  turn(80'000);
  ASSERT_EQ(fake_bus::state().waited.size(), 1U);
  EXPECT_EQ(fake_bus::state().waited.front().count(), 0);
}

// After a stall: each measurement has its tick, with the request that answered the one before it.
TEST_F(SupervisorLoopBench, TakesABurstInOrderWithTheRequestsThatBelongToIt) {
  turn(10'000);
  for (std::uint32_t n = 1; n <= 5; ++n) {
    Measurement measured;
    measured.seq = 100 + n;
    fake_bus::put(measured);
    DriveRequest request;
    request.seq = 200 + n;
    if (n > 2) fake_bus::put(request);
  }
  const std::size_t before = calls.supervised.size();
  fake_bus::set_clock_us(kStart_us + 15'000);
  loop.turn();
  ASSERT_EQ(calls.supervised.size(), before + 5);
  std::int64_t at_us = 0;
  for (std::uint32_t n = 1; n <= 5; ++n) {
    const robot::SupervisorSources& in = calls.supervised[before + n - 1];
    EXPECT_EQ(in.measurement.seq, 100 + n);
    EXPECT_EQ(in.request.seq, n > 2 ? 200 + n : 0U) << "none before the third";
    EXPECT_GT(in.now_us, at_us) << "strictly later";
    at_us = in.now_us;
  }
}

TEST_F(SupervisorLoopBench, MoreRequestsThanMeasurementsLeaveTheNewestToTheLastTick) {
  turn(10'000);
  for (std::uint32_t n = 1; n <= 4; ++n) {
    DriveRequest request;
    request.seq = 200 + n;
    fake_bus::put(request);
  }
  turn(11'000);
  EXPECT_EQ(last().request.seq, 204U);
  DriveRequest alone;
  alone.seq = 205;
  fake_bus::put(alone);
  loop.turn();  // no measurement comes
  EXPECT_EQ(last().request.seq, 205U);
}

TEST_F(SupervisorLoopBench, CountsPeriodsThatItMissedAndHowLateItWas) {
  turn(10'000);
  turn(11'000);
  EXPECT_EQ(loop.heartbeat().health().overruns, 0U);
  turn(15'400);  // 3.4 ms late
  EXPECT_EQ(loop.heartbeat().health().overruns, 3U);
  EXPECT_EQ(loop.heartbeat().lateness().max_us(), 3'400);
  turn(17'400);  // one millisecond late: one period missed
  EXPECT_EQ(loop.heartbeat().health().overruns, 4U);
}

TEST_F(SupervisorLoopBench, ATickThatComesEarlyIsNotLate) {
  turn(10'000);
  turn(10'200);
  turn(10'400);
  EXPECT_EQ(loop.heartbeat().lateness().max_us(), 0);
  EXPECT_EQ(loop.heartbeat().health().overruns, 0U);
}

TEST_F(SupervisorLoopBench, SaysThatItIsReadyTenTimesASecond) {
  fake_bus::written<Health>();
  std::size_t sent = 0;
  Health health;
  for (int n = 1; n <= 1'000; ++n) {
    turn(1'000 * n);
    for (const Health& each : fake_bus::written<Health>()) health = each, ++sent;
  }
  EXPECT_EQ(sent, 10U);
  EXPECT_EQ(health.process, Process::Supervisor);
  EXPECT_EQ(health.config_tag, kConfig);
  EXPECT_TRUE(health.ready);
}

TEST_F(SupervisorLoopBench, AWakeAfterItsTimeIsATick) {
  turn(10'000);
  fake_bus::state().on_wait = [](std::chrono::nanoseconds timeout) {
    fake_bus::state().now_ns += timeout.count() + 300'000;
  };
  loop.turn();
  ASSERT_EQ(calls.supervised.size(), 2U);
  EXPECT_EQ(last().now_us - (kStart_us + 10'000), 1'800);
}

TEST_F(SupervisorLoopBench, TakesTheRequestsOfEachTurnForEver) {
  for (std::uint32_t n = 1; n <= 40; ++n) {
    DriveRequest request;
    request.seq = 500 + n;
    fake_bus::put(request);
    turn(1'000 * n);
    ASSERT_EQ(last().request.seq, 500 + n);
  }
}

TEST_F(SupervisorLoopBench, TakesAsManyAsTheBusKeeps) {
  for (std::uint32_t n = 1; n <= 16; ++n) {
    Measurement measured;
    measured.seq = 100 + n;
    fake_bus::put(measured);
    DriveRequest request;
    request.seq = 200 + n;
    fake_bus::put(request);
  }
  loop.turn();
  ASSERT_EQ(calls.supervised.size(), 16U);
  for (std::uint32_t n = 1; n <= 16; ++n) {
    EXPECT_EQ(calls.supervised[n - 1].measurement.seq, 100 + n);
    EXPECT_EQ(calls.supervised[n - 1].request.seq, 200 + n);
  }
}

TEST_F(SupervisorLoopBench, KnowsTheConfigurationOfTheFilesForFiveSecondsAfterTheyWereRead) {
  turn(1'000);
  EXPECT_EQ(last().files_tag, 0U) << "never read";
  files.set(77, kStart_us);
  turn(2'000);
  EXPECT_EQ(last().files_tag, 77U);
  turn(5'000'000);
  EXPECT_EQ(last().files_tag, 77U);
  turn(5'000'001);
  EXPECT_EQ(last().files_tag, 0U) << "the disk, or the thread that reads, stands still";
  files.set(0, kStart_us + 5'000'002);
  turn(5'000'003);
  EXPECT_EQ(last().files_tag, 0U) << "a file cannot be read";
}

TEST_F(SupervisorLoopBench, AsksForTheFilesToBeReadWhereTheArmKeyWasTurnedAfterTheyWere) {
  files.set(77, kStart_us);
  turn(1'000);
  EXPECT_EQ(last().files_read_us, kStart_us);
  EXPECT_FALSE(files.take_request()) << "the key is not turned";
  for (const auto& [turned_us, is_asked] : {std::pair{kStart_us, false}, {kStart_us + 1, true}}) {
    calls.arm_turned_us = turned_us;
    turn(2'000);
    EXPECT_EQ(files.take_request(), is_asked);
    EXPECT_FALSE(files.take_request()) << "once";
  }
  files.set(78, kStart_us + 1);
  turn(3'000);
  EXPECT_FALSE(files.take_request());
  EXPECT_EQ(last().files_tag, 78U);
  EXPECT_EQ(last().files_read_us, kStart_us + 1);
}

}  // namespace
}  // namespace biopsy::loops_tests
