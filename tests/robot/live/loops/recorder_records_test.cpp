// How soon the recorder's loop writes, in both directions of a change, flag by flag, and how it tells of
// itself.
#include "tests/robot/live/loops/recorder_bench.hpp"

namespace biopsy::loops_tests {
namespace {

TEST_F(RecorderLoopBench, WritesThatASensorMeasuresThePatientAndEachTimeTheyPassTheThreshold) {
  const auto body_after = [this](bool measures, std::int32_t um) {
    const std::vector<Record> records =
        after(NavigationRequest{.measures_patient = measures, .patient_motion_um = um});
    return records.empty() ? json() : json::parse(records.at(0).body);
  };
  const auto body = [](bool measured, double mm) {
    return json{{"patient_measured", measured}, {"patient_motion_mm", mm}};
  };
  EXPECT_EQ(body_after(false, INT32_MAX), json()) << "a navigation program without a sensor";
  EXPECT_EQ(body_after(true, 300), body(true, 0.3));
  EXPECT_EQ(body_after(true, 2'000), json());
  EXPECT_EQ(body_after(true, 2'001), body(true, 2.001));
  EXPECT_EQ(body_after(true, 9'000), json());
  EXPECT_EQ(body_after(true, 100), body(true, 0.1));
  EXPECT_EQ(body_after(true, -1), body(true, -0.001));
  EXPECT_EQ(body_after(true, 0), body(true, 0.0));
  const std::vector<Record> gone =
      after(NavigationRequest{.measures_patient = false, .patient_motion_um = 0});
  ASSERT_EQ(kinds(gone), "alarm");
  EXPECT_EQ(gone[0].source, "navigation");
  EXPECT_EQ(json::parse(gone[0].body), body(false, 0.0));
}

TEST_F(RecorderLoopBench, WritesWhatIsUrgentAtOnceAndTheRestWithinAHundredMilliseconds) {
  const auto on_disk = [&] {
    return recorder::records_of(folder_of_log.log, folder_of_log.public_key()).size();
  };
  const auto expect = [&](bool urgent, const char* what, const auto& message) {
    log.flush(now_us);
    const std::size_t had = on_disk();
    fake_bus::put(message);
    turn();
    EXPECT_EQ(on_disk() - had, urgent ? 1U : 0U) << what;
    for (int n = 0; n < 9; ++n) turn();
    EXPECT_EQ(on_disk() - had, 1U) << what << ", without a flush";
  };
  Decision decision;
  decision.worst = static_cast<std::uint8_t>(safety::Hazard::None);
  decision.session = 1, decision.seq = 1;
  expect(true, "state change", decision);
  decision.seq = 2, decision.step = 3;
  expect(false, "permit change", decision);
  decision.seq = 3, decision.worst = static_cast<std::uint8_t>(safety::Hazard::Arc);
  expect(false, "alarm", decision);
  decision.seq = 4, decision.refusal = 1;
  expect(false, "request refused", decision);
  decision.seq = 9;
  expect(false, "reception gap", decision);
  decision.seq = 10, decision.estop = !decision.estop;
  expect(false, "an emergency stop beside it", decision);
  OperatorAct act;
  act.token = 1;
  expect(false, "operator act", act);
  expect(true, "plan", SealedPlan{1, {}, {}, {}});
  expect(true, "plan confirmation", PlanConfirmation{});
  expect(true, "depth check", DepthVerdictNote{});
  Measurement measured;
  measured.hv_enabled = true;
  expect(false, "gate", measured);
  DriveRequest asked;
  asked.finished = true;
  expect(false, "request", asked);
  Health health;
  health.process = Process::Stage, health.seq = 1;
  expect(true, "process start", health);
  health.refused = 1;
  expect(false, "strangers", health);
  health.note = "dust";
  expect(false, "note", health);
  fake_bus::state().endpoints = 1;
  expect(false, "endpoints", health);
  expect(false, "a sensor of the patient", NavigationRequest{.measures_patient = true});
  const std::size_t had = on_disk();
  loop.note(recorder::RecordKind::ProcessStart, "{}", now_us);
  EXPECT_EQ(on_disk() - had, 1U) << "its own start";
}

TEST_F(RecorderLoopBench, WritesWhatTheBusTellsWithinAHundredMillisecondsToo) {
  const auto on_disk = [&](const char* text) {
    std::ptrdiff_t found = 0;
    for (const Record& record : recorder::records_of(folder_of_log.log, folder_of_log.public_key()))
      found += record.body.find(text) != std::string::npos ? 1 : 0;
    return found;
  };
  const auto expect = [&](const char* text, std::int64_t us) {
    log.flush(now_us);
    const std::ptrdiff_t had = on_disk(text);
    loop.turn(now_us += us);
    EXPECT_EQ(on_disk(text), had) << text;
    for (int n = 0; n < 10; ++n) turn();
    EXPECT_EQ(on_disk(text), had + 1) << text << ", without a flush";
  };
  fake_bus::channel<Measurement>().missed = 3;
  expect("deadlines_missed", 200'000);
  fake_bus::state().participants = 2;
  turn();
  expect("participants_not_let_in", 1'500'000);
}

// 50 requests a second come from a button that stays down after a stop.
TEST_F(RecorderLoopBench, WritesARefusalOnceUntilItWasQuietForASecond) {
  Decision decision;
  decision.worst = static_cast<std::uint8_t>(safety::Hazard::None);
  decision.session = 4, decision.seq = 1, decision.time_us = 7'000'000;
  (void)after(decision);
  const auto kinds_of = [&](std::int64_t later_us, std::uint8_t refusal) {
    ++decision.seq;
    decision.time_us += later_us, decision.refusal = refusal;
    return kinds(after(decision));
  };
  EXPECT_EQ(kinds_of(1'000, 3), "request refused");
  for (int n = 0; n < 5; ++n) {
    EXPECT_EQ(kinds_of(1'000, 0), "");
    EXPECT_EQ(kinds_of(600'000, 3), "") << n;  // asked again within a second of the last time
  }
  EXPECT_EQ(kinds_of(1'000, 0), "");
  EXPECT_EQ(kinds_of(998'999, 3), "");
  EXPECT_EQ(kinds_of(1'000'000, 3), "request refused");
  EXPECT_EQ(kinds_of(2'500'000, 3), "request refused");
  EXPECT_EQ(kinds_of(1'000, 5), "request refused") << "another reason";
  EXPECT_EQ(kinds_of(1'000, 3), "request refused") << "and back";
  EXPECT_EQ(kinds_of(1'200'000, 0), "");
  EXPECT_EQ(kinds_of(300'000, 3), "request refused") << "a second and a half after the last one";
  for (const std::uint32_t session : {5U, 2U}) {  // another supervisor; also one whose clock was set back
    decision.session = session, decision.seq = 0;
    EXPECT_EQ(kinds_of(1'000, 0), "state change");
    EXPECT_EQ(kinds_of(1'000, 3), "request refused") << session;
  }
}

TEST_F(RecorderLoopBench, WritesChangesInBothDirections) {
  const auto kinds_after = [&](const auto& message) { return kinds(after(message)); };
  Decision decision;
  decision.worst = static_cast<std::uint8_t>(safety::Hazard::None);
  for (const std::uint32_t seq : {5U, 6U, 9U}) {  // of session 0 too
    decision.seq = seq;
    EXPECT_EQ(kinds_after(decision), seq == 9 ? "reception gap" : "") << seq;
  }
  decision.session = 9, decision.seq = 70, decision.step = 5;
  (void)after(decision);
  decision.session = 8, decision.seq = 3;  // another supervisor, with a clock that was set back
  EXPECT_EQ(kinds_after(decision), "state change");
  decision.seq = 4, decision.step = 2, decision.image_allowed = true;
  EXPECT_EQ(kinds_after(decision), "permit change");
  decision.seq = 2;
  EXPECT_EQ(kinds_after(decision), "reception gap");
  decision.seq = 3, decision.refusal = 1, decision.event = 0;
  std::vector<Record> records = after(decision);
  ASSERT_EQ(kinds(records), "request refused");
  EXPECT_EQ(json::parse(records[0].body)["seq"], 3);
  decision.seq = 4;
  EXPECT_EQ(kinds_after(decision), "") << "the same refusal";
  decision.seq = 5, decision.refusal = 2;
  EXPECT_EQ(kinds_after(decision), "request refused") << "for another reason";
  decision.seq = 6, decision.refusal = 0;
  EXPECT_EQ(kinds_after(decision), "");
  decision.seq = 7, decision.worst = 3;
  records = after(decision);
  EXPECT_EQ(json::parse(records.at(0).body)["seq"], 7);
  DriveRequest asked;
  asked.step = 4, asked.finished = true;
  (void)after(asked);
  asked.step = 1;
  EXPECT_EQ(kinds_after(asked), "request");
  Health health;
  health.process = Process::Interlock, health.seq = 1, health.refused = 7;
  (void)after(health);
  health.refused = 2;
  EXPECT_EQ(kinds_after(health), "alarm");
  for (const int endpoints : {3, 1}) {
    fake_bus::state().endpoints = endpoints;
    EXPECT_EQ(kinds_after(asked), "alarm") << endpoints;
  }
}

TEST_F(RecorderLoopBench, NamesEachFlagOfAnActByItsOwnName) {
  OperatorAct idle;
  idle.acquiring = false;
  for (const auto& [flag, name] : {std::pair{&OperatorAct::held, "held"},
                                   {&OperatorAct::finish, "finish"},
                                   {&OperatorAct::acquiring, "acquiring"},
                                   {&OperatorAct::arm, "asks_arm"},
                                   {&OperatorAct::reset, "asks_reset"},
                                   {&OperatorAct::hold_still, ""}}) {
    OperatorAct act = idle;
    act.*flag = true;
    const std::vector<Record> records = after(act);
    ASSERT_EQ(records.size(), 1U);
    const json body = json::parse(records[0].body);
    for (const char* each : {"held", "finish", "acquiring", "asks_arm", "asks_reset"})
      EXPECT_EQ(body[each], std::string(each) == name) << name;
    (void)after(idle);
  }
}

TEST_F(RecorderLoopBench, ComparesEachFlagWithItself) {
  DriveRequest asked;
  for (const auto flag : {&DriveRequest::step_reached, &DriveRequest::finished}) {
    asked = {};
    (void)after(asked);
    asked.*flag = true;
    EXPECT_EQ(json::parse(after(asked).at(0).body),
              (json{{"stage", 1}, {"reached", asked.step_reached}, {"finished", asked.finished}}));
    EXPECT_EQ(kinds(after(asked)), "");
  }
  Measurement measured;
  measured.hv_enabled = true;
  (void)after(measured);
  EXPECT_EQ(kinds(after(measured)), "");
}

TEST_F(RecorderLoopBench, WritesWhatAPlanIsFor) {
  Plan plan;
  plan.target.patient_id = "P-7";
  plan.target.series_uid = "1.2.3";
  plan.target_depth = Millimetres(3.5);
  plan.steps.resize(2);
  planner::seal(plan);
  const std::uint64_t tag = planner::plan_tag(plan);
  const auto body = [&](std::uint64_t first, std::uint64_t second) {
    return json::parse(
        after(SealedPlan{1, planner::canonical_bytes(plan), plan.seal, {first, second}}).at(0).body);
  };
  const json written = body(tag, tag);
  EXPECT_EQ(written["seal_holds"], true);
  EXPECT_EQ(written["patient"], "P-7");
  EXPECT_EQ(written["series_uid"], "1.2.3");
  EXPECT_EQ(written["target_mm"], 3.5);
  EXPECT_EQ(written["stages"], 2);
  EXPECT_EQ(written["confirmations"], 2);
  for (const std::uint64_t other : {tag - 1, tag + 1}) {
    EXPECT_EQ(body(tag, other)["confirmations"], 1);
    EXPECT_EQ(body(other, tag)["confirmations"], 1);
    EXPECT_EQ(body(other, other)["confirmations"], 0);
  }
}

TEST_F(RecorderLoopBench, WritesWhoConfirmedAPlanAsTheSecondPerson) {
  const Record record = after(PlanConfirmation{1, {0x00, 0xAB, 0xCD}, "Dr. B"}).at(0);
  EXPECT_EQ(record.kind, "plan confirmation");
  EXPECT_EQ(record.source, "confirmer");
  EXPECT_EQ(json::parse(record.body),
            (json{{"operator", "Dr. B"}, {"seal", "00abcd" + std::string(58, '0')}}));
}

TEST_F(RecorderLoopBench, KeepsTextAsItIsAndReplacesBytesThatAreNone) {
  Health health;
  health.process = Process::Stage, health.seq = 1;
  (void)after(health);
  health.note = "Nadel \xC3\xA4";
  EXPECT_EQ(after(health).at(0).body, "{\"note\":\"Nadel \xC3\xA4\"}");
  health.note = "x\xC3";
  EXPECT_EQ(after(health).at(0).body, "{\"note\":\"x\xEF\xBF\xBD\"}");
  const auto wall = std::chrono::system_clock::now().time_since_epoch();
  health.note = "later";
  EXPECT_NEAR(static_cast<double>(after(health).at(0).utc_ns) * 1e-9,
              std::chrono::duration<double>(wall).count(), 60.0);
}

TEST_F(RecorderLoopBench, WritesAWriterThatFallsSilentOrMissesDeadlinesEachAlone) {
  auto& channel = fake_bus::channel<Measurement>();
  const auto told = [&] {
    loop.turn(now_us += 200'000);
    return kinds(news());
  };
  (void)told();
  channel.alive = 0;
  EXPECT_EQ(told(), "alarm");
  channel.alive = 1;
  EXPECT_EQ(told(), "alarm");
  channel.missed = 4;
  EXPECT_EQ(told(), "alarm");
  channel.missed = 2;
  EXPECT_EQ(told(), "alarm");
  EXPECT_EQ(told(), "");
  channel.alive = 0;
  loop.turn(now_us += 199'999);
  EXPECT_EQ(kinds(news()), "") << "asked every 200 ms";
  channel.alive = 1;
  loop.turn(now_us += 100);
  EXPECT_EQ(kinds(news()), "") << "it was back in between";
}

TEST_F(RecorderLoopBench, SaysInItsHealthWhatKeepsItFromWriting) {
  std::filesystem::remove(folder_of_log.log);
  fake_bus::put(SealedPlan{});
  for (int n = 0; n < 20; ++n) turn();
  const std::vector<Health> sent = fake_bus::written<Health>();
  ASSERT_FALSE(sent.empty());
  EXPECT_EQ(sent.back().note, log.last_error().substr(0, 120));
  EXPECT_NE(sent.back().note, "");
}

TEST_F(RecorderLoopBench, RunsOnABusWithoutSecurity) {
  robot::BusRecorder open(bus, log, kConfig, nullptr);
  open.turn(now_us);
  fake_bus::state().endpoints = 2;
  open.turn(now_us += 10'000);
  for (const Record& record : news()) EXPECT_EQ(record.body.find("endpoints"), std::string::npos);
}

TEST_F(RecorderLoopBench, TellsParticipantsWithoutKeysOnceTheyStayedForAnAuthentication) {
  // Alarms about participants in the turn that is `us` after the last.
  const auto told_after = [&](std::int64_t us) {
    loop.turn(now_us += us);
    std::vector<json> bodies;
    for (const Record& record : news())
      if (record.kind == "alarm") bodies.push_back(json::parse(record.body));
    return bodies;
  };
  const std::vector<json> nothing;
  const auto outside = [](int count) { return std::vector{json{{"participants_not_let_in", count}}}; };
  fake_bus::state().participants = 3;
  EXPECT_EQ(told_after(10'000), nothing);
  EXPECT_EQ(told_after(1'499'999), nothing);
  EXPECT_EQ(told_after(1), outside(3));
  EXPECT_EQ(told_after(2'000'000), nothing) << "once";
  fake_bus::state().participants = 1;  // two left
  EXPECT_EQ(told_after(10'000), nothing);
  EXPECT_EQ(told_after(1'500'001), outside(1));
  fake_bus::state().participants = 2;
  EXPECT_EQ(told_after(10'000), nothing);
  fake_bus::state().participants = 4;  // another came meanwhile: its time counts
  EXPECT_EQ(told_after(1'400'000), nothing);
  EXPECT_EQ(told_after(200'000), nothing);
  EXPECT_EQ(told_after(1'300'000), outside(4));
}

TEST_F(RecorderLoopBench, ReportsEveryFiftyMillisecondsInWholeMillisecondsOfItsClock) {
  Decision decision;
  decision.worst = static_cast<std::uint8_t>(safety::Hazard::None);
  fake_bus::put(decision), fake_bus::put(Measurement{}), fake_bus::put(DriveRequest{});
  loop.turn(now_us += 50'000);
  fake_bus::written<LogHealth>();
  loop.turn(now_us + 49'999);
  EXPECT_TRUE(fake_bus::written<LogHealth>().empty());
  log.flush(now_us);
  loop.turn(now_us + 50'000);
  ASSERT_EQ(fake_bus::written<LogHealth>().size(), 1U);
  loop.turn(now_us + 10'000'999);
  const std::vector<LogHealth> sent = fake_bus::written<LogHealth>();
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_EQ(sent.front().backlog_ms, 10'000);
}

}  // namespace
}  // namespace biopsy::loops_tests
