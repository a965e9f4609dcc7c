// Which change of which field on the bus the recorder's loop writes down, of which kind, and with what in it.
#include <map>

#include "tests/robot/live/loops/recorder_bench.hpp"

namespace biopsy::loops_tests {
namespace {

// Every field that changes alone, and the records that it makes; a field that the table leaves out makes
// none.
template <class Message>
void expect_kinds(RecorderLoopBench& bench, const Message& base,
                  const std::map<std::size_t, std::string>& records_of_field) {
  std::size_t field = 0;
  fields::for_each_field(base, [&](auto, const Message& message) {
    (void)bench.after(base);
    const auto found = records_of_field.find(field);
    EXPECT_EQ(bench.kinds(bench.after(message)), found == records_of_field.end() ? "" : found->second)
        << "field " << field;
    ++field;
  });
}

template <class Message, class Member>
std::size_t index_of(Member wanted) {
  std::size_t index = 0, found = SIZE_MAX;
  fields::for_each_field(Message{}, [&](auto member, const Message&) {
    if (fields::same_member(member, wanted)) found = index;
    ++index;
  });
  return found;
}

TEST_F(RecorderLoopBench, BeginsWithItselfAndTheWritersThatItFinds) {
  EXPECT_EQ(kinds(began), "alarm, alarm, alarm, process start");
  EXPECT_EQ(began.back().source, "recorder");
  loop.note(recorder::RecordKind::ProcessStop, "{}", now_us);
  EXPECT_EQ(kinds(news()), "process stop");
  EXPECT_TRUE(loop.health().ready);
  EXPECT_EQ(loop.health().process, Process::Recorder);
  EXPECT_EQ(loop.health().config_tag, kConfig);
}

TEST_F(RecorderLoopBench, WritesADecisionForEachFieldThatSaysSomethingNew) {
  Decision base = fields::distinct<Decision>(50);
  base.refusal = 0;
  base.worst = base.reason = 1;
  const auto at = [](auto member) { return index_of<Decision>(member); };
  // The same number again, or a gap to it, is a gap of reception: the table's messages repeat or skip one.
  std::size_t field = 0;
  std::uint32_t seq = 1'000;
  const std::map<std::size_t, std::string> table{{at(&Decision::mode), "state change"},
                                                 {at(&Decision::session), "state change"},
                                                 {at(&Decision::stop), "permit change"},
                                                 {at(&Decision::step), "permit change"},
                                                 {at(&Decision::step_done), "permit change"},
                                                 {at(&Decision::worst), "alarm"},
                                                 {at(&Decision::estop), "alarm"},
                                                 {at(&Decision::refusal), "request refused"},
                                                 {at(&Decision::seq), "reception gap"}};
  fields::for_each_field(base, [&](auto member, Decision changed) {
    Decision first = base;
    first.seq = seq++;
    first.session = 7'000 + seq;  // a new session: no gap
    changed.session = first.session + (fields::same_member(member, &Decision::session) ? 1 : 0);
    (void)after(first);
    changed.seq = seq++ + (fields::same_member(member, &Decision::seq) ? 1 : 0);
    const auto found = table.find(field);
    EXPECT_EQ(kinds(after(changed)), found == table.end() ? "" : found->second) << "field " << field;
    ++field;
  });
}

TEST_F(RecorderLoopBench, SaysWhatWasDecidedWithTheSupervisorsOwnTimes) {
  Decision decision;
  decision.seq = 9;
  decision.time_us = 123;
  decision.at_ns = 456;
  decision.session = 3;
  decision.epoch = 2;
  decision.mode = Mode::Hold;
  decision.stop = StopCategory::C1Ramp;
  decision.event = 1;
  decision.reason = static_cast<std::uint8_t>(safety::Hazard::Arc);
  decision.worst = static_cast<std::uint8_t>(safety::Hazard::OverDepth);
  decision.step = 4;
  decision.step_done = true;
  const std::vector<Record> records = after(decision);
  ASSERT_EQ(kinds(records), "state change, alarm");
  EXPECT_EQ(records[0].source, "supervisor");
  EXPECT_EQ(records[0].mono_us, 123);
  EXPECT_EQ(records[0].utc_ns, 456);
  const json expected{{"mode", "hold"},
                      {"event", safety::name_of(static_cast<safety::Event>(1))},
                      {"reason", safety::name_of(safety::Hazard::Arc)},
                      {"worst", safety::name_of(safety::Hazard::OverDepth)},
                      {"stop", 2},
                      {"stage", 5},
                      {"stage_done", true},
                      {"session", 3},
                      {"epoch", 2},
                      {"seq", 9}};
  EXPECT_EQ(json::parse(records[0].body), expected);
  EXPECT_EQ(json::parse(records[1].body)["worst"], safety::name_of(safety::Hazard::OverDepth));
  EXPECT_EQ(json::parse(records[1].body)["before"], safety::name_of(safety::Hazard::None));
  decision.seq = 13;
  decision.refusal = 1;
  decision.event = 250;
  decision.stop = StopCategory::None;
  const std::vector<Record> more = after(decision);
  ASSERT_EQ(kinds(more), "reception gap, permit change, request refused");
  EXPECT_EQ(json::parse(more[0].body), (json{{"from_seq", 10}, {"to_seq", 12}}));
  EXPECT_EQ(json::parse(more[1].body)["event"], "unknown");
  EXPECT_EQ(json::parse(more[2].body)["why"], safety::name_of(static_cast<safety::Refusal>(1)));
}

TEST_F(RecorderLoopBench, WritesWhyTheEmergencyStopWasFoundAndThatAgainWhereItChanges) {
  Decision decision;
  decision.session = 1, decision.seq = 1;
  decision.worst = static_cast<std::uint8_t>(safety::Hazard::None);
  (void)after(decision);
  std::string before;
  const auto alarm = [&](std::int32_t unread_ms) {
    ++decision.seq, decision.panel_unread_ms = unread_ms;
    const std::vector<Record> records = after(decision);
    if (records.empty()) return std::string();
    before = json::parse(records.at(0).body)["before"];
    return json::parse(records.at(0).body)["worst"].get<std::string>();
  };
  decision.worst = static_cast<std::uint8_t>(safety::Hazard::EStop);
  EXPECT_EQ(alarm(20), robot::hazard_text(safety::Hazard::EStop, 20));
  EXPECT_EQ(alarm(20), "");
  EXPECT_EQ(alarm(143), robot::hazard_text(safety::Hazard::EStop, 143)) << "read again";
  EXPECT_EQ(before, robot::hazard_text(safety::Hazard::EStop, 20));
  EXPECT_EQ(alarm(0), "H-25 emergency stop pressed");
  decision.worst = static_cast<std::uint8_t>(safety::Hazard::Arc);
  EXPECT_EQ(alarm(0), safety::name_of(safety::Hazard::Arc));
  EXPECT_EQ(alarm(30), "") << "not what is the matter now";
}

// A trip for an arc, the button pressed in it and let go: nothing else in a decision tells of it.
TEST_F(RecorderLoopBench, WritesAnEmergencyStopThatIsPressedBesideAWorseHazard) {
  Decision decision;
  decision.session = 100, decision.estop = false;
  decision.worst = static_cast<std::uint8_t>(safety::Hazard::Arc);
  const auto beside = [&](bool estop) {
    ++decision.seq, decision.estop = estop;
    std::string told;
    for (const Record& record : after(decision))
      if (const json body = json::parse(record.body); body.contains("beside")) {
        told += body["beside"].get<std::string>() + (body["over"].get<bool>() ? ", over" : "");
        EXPECT_EQ(body["seq"], decision.seq);
      }
    return told;
  };
  EXPECT_EQ(beside(false), "");
  const std::string name = robot::hazard_text(safety::Hazard::EStop, decision.panel_unread_ms);
  EXPECT_EQ(beside(true), name);
  EXPECT_EQ(beside(true), "");
  EXPECT_EQ(beside(false), name + ", over");
  decision.worst = static_cast<std::uint8_t>(safety::Hazard::EStop);
  EXPECT_EQ(beside(true), "") << "it is the worst";
  decision.worst = static_cast<std::uint8_t>(safety::Hazard::Arc);
  EXPECT_EQ(beside(false), "") << "it was";
}

TEST_F(RecorderLoopBench, WritesEveryChangeOfAnActButNotItsRepetition) {
  OperatorAct base = fields::distinct<OperatorAct>(80);
  base.token = 500;  // no number is the next of its neighbour
  std::size_t field = 0;
  fields::for_each_field(base, [&](auto member, const OperatorAct& act) {
    (void)after(base);
    const std::vector<Record> records = after(act);
    EXPECT_EQ(kinds(records), fields::same_member(member, &OperatorAct::seq) ? "" : "operator act") << field;
    ++field;
  });
  OperatorAct act;
  act.token = 5, act.held = true, act.stop = StopCategory::C2Hold, act.finish = true, act.acquiring = false,
  act.arm = true, act.patient_motion_um = 1'250;
  const std::vector<Record> records = after(act);
  ASSERT_EQ(records.size(), 1U);
  const json body = json::parse(records[0].body);
  EXPECT_EQ(body["token"], 5);
  EXPECT_EQ(body["held"], true);
  EXPECT_EQ(body["stop"], 1);
  EXPECT_EQ(body["finish"], true);
  EXPECT_EQ(body["acquiring"], false);
  EXPECT_EQ(body["asks_arm"], true);
  EXPECT_EQ(body["asks_reset"], false);
  EXPECT_EQ(body["hold_still"], false);
  EXPECT_EQ(body["patient_motion_mm"], 1.25);
  act.arm = false, act.hold_still = true;
  EXPECT_EQ(json::parse(after(act).at(0).body)["hold_still"], true);
}

// Who operates is what the person's process says of itself, and it stands in every act.
TEST_F(RecorderLoopBench, NamesTheOperatorInEveryRecordOfAPerson) {
  Health person;
  person.process = Process::Person;
  person.seq = 1, person.ready = true, person.note = "Dr. Who";
  const std::vector<Record> start = after(person);
  ASSERT_EQ(kinds(start), "process start");
  EXPECT_EQ(json::parse(start[0].body)["operator"], "Dr. Who");
  Health stage;
  stage.process = Process::Stage;
  stage.seq = 1, stage.note = "a fault";
  const std::vector<Record> other = after(stage);
  ASSERT_FALSE(other.empty());
  EXPECT_FALSE(json::parse(other[0].body).contains("operator")) << "a process is no operator";
  OperatorAct act;
  act.token = 5;
  EXPECT_EQ(json::parse(after(act).at(0).body)["operator"], "Dr. Who");
  DepthVerdictNote verdict;
  verdict.seq = 5;
  EXPECT_EQ(json::parse(after(verdict).at(0).body)["operator"], "Dr. Who");
  EXPECT_EQ(json::parse(after(SealedPlan{1, {1, 2, 3}, {0xAB}, {}}).at(0).body)["operator"], "Dr. Who");
}

TEST_F(RecorderLoopBench, WritesWhatTheGateRefusesWhenHighVoltageSwitchesAndWhatIsRequestedAnew) {
  Measurement base;
  base.verdict = GateVerdict::Granted;
  expect_kinds(*this, base,
               {{index_of<Measurement>(&Measurement::hv_enabled), "permit change"},
                {index_of<Measurement>(&Measurement::verdict), "permit change"}});
  for (const GateVerdict usual : {GateVerdict::Limited, GateVerdict::NoRequest}) {
    Measurement other = base;
    (void)after(base);
    other.verdict = usual;
    EXPECT_EQ(kinds(after(other)), "");
  }
  Measurement told = base;
  told.hv_enabled = true, told.command_mV = 2'500'000, told.depth_um = 1'250, told.seq = 6;
  const std::vector<Record> records = after(told);
  ASSERT_EQ(kinds(records), "permit change");
  EXPECT_EQ(records[0].source, "stage");
  EXPECT_EQ(json::parse(records[0].body),
            (json{{"gate", 1}, {"hv_enabled", true}, {"command_kV", 2.5}, {"depth_mm", 1.25}, {"seq", 6}}));
  expect_kinds(*this, fields::distinct<DriveRequest>(20),
               {{index_of<DriveRequest>(&DriveRequest::step), "request"},
                {index_of<DriveRequest>(&DriveRequest::step_reached), "request"},
                {index_of<DriveRequest>(&DriveRequest::finished), "request"}});
  DriveRequest asked;
  asked.step = 1, asked.step_reached = true;
  EXPECT_EQ(json::parse(after(asked).at(0).body),
            (json{{"stage", 2}, {"reached", true}, {"finished", false}}));
}

TEST_F(RecorderLoopBench, WritesDepthChecksAndPlansThatAreSent) {
  DepthVerdictNote verdict;
  verdict.seq = 5, verdict.step = 2, verdict.accepted = true, verdict.since_seq = 900;
  const std::vector<Record> records = after(verdict);
  ASSERT_EQ(kinds(records), "depth check");
  EXPECT_EQ(json::parse(records[0].body)["stage"], 3);
  EXPECT_EQ(json::parse(records[0].body)["accepted"], true);
  EXPECT_EQ(json::parse(records[0].body)["since_seq"], 900);
  const std::vector<Record> plan = after(SealedPlan{1, {1, 2, 3}, {0xAB}, {}});
  ASSERT_EQ(kinds(plan), "plan");
  EXPECT_EQ(json::parse(plan[0].body)["seal_holds"], false);
  EXPECT_EQ(json::parse(plan[0].body)["seal"].get<std::string>().substr(0, 4), "ab00");
}

TEST_F(RecorderLoopBench, WritesThatAProcessBeginsEndsRefusesAndWhatItSays) {
  Health health;
  health.process = Process::Stage;
  health.seq = 1;
  health.config_tag = 0xAB;
  std::vector<Record> records = after(health);
  ASSERT_EQ(kinds(records), "process start");
  EXPECT_EQ(records[0].source, "stage");
  EXPECT_EQ(json::parse(records[0].body), (json{{"alive", true}, {"config", "00000000000000ab"}}));
  EXPECT_EQ(kinds(after(health)), "");
  health.refused = 4;
  records = after(health);
  ASSERT_EQ(kinds(records), "alarm");
  EXPECT_EQ(json::parse(records[0].body), (json{{"strangers_refused", 4}}));
  health.note = "dust";
  records = after(health);
  ASSERT_EQ(kinds(records), "alarm");
  EXPECT_EQ(json::parse(records[0].body), (json{{"note", "dust"}}));
  const std::int64_t heard_us = now_us;
  for (records.clear(); records.empty() && now_us < heard_us + 1'000'000; records = news()) turn();
  EXPECT_EQ(now_us - heard_us, 510'000);
  ASSERT_EQ(kinds(records), "process stop");
  EXPECT_EQ(json::parse(records[0].body)["alive"], false);
}

TEST_F(RecorderLoopBench, WritesWhoIsOnTheNetworkWithoutKeys) {
  fake_bus::state().endpoints = 2;
  turn();
  std::vector<Record> records = news();
  ASSERT_EQ(kinds(records), "alarm");
  EXPECT_EQ(json::parse(records[0].body), (json{{"endpoints_without_keys", 2}}));
  fake_bus::state().participants = 3;
  const std::int64_t came_us = now_us + 10'000;
  std::int64_t told_us = 0;
  for (int n = 0; n < 200; ++n) {
    turn();
    records = news();
    if (records.empty()) continue;
    EXPECT_EQ(json::parse(records[0].body), (json{{"participants_not_let_in", 3}}));
    EXPECT_EQ(told_us, 0) << "once";
    told_us = now_us;
  }
  EXPECT_EQ(told_us - came_us, 1'500'000) << "time for an authentication that succeeds";
}

TEST_F(RecorderLoopBench, WritesWritersThatFallSilentByTheNameOfTheirTopic) {
  const auto told = [&](const char* topic, auto& channel) {
    now_us += 200'000;
    turn();
    (void)news();
    channel.alive = 0, channel.missed += 3;
    now_us += 200'000;
    turn();
    const std::vector<Record> records = news();
    ASSERT_EQ(kinds(records), "alarm") << topic;
    const json body = json::parse(records[0].body);
    EXPECT_EQ(body["topic"], topic);
    EXPECT_EQ(body["writers_alive"], 0);
    EXPECT_EQ(body["deadlines_missed"], 3);
  };
  told("Decision", fake_bus::channel<Decision>());
  told("Measurement", fake_bus::channel<Measurement>());
  told("DriveRequest", fake_bus::channel<DriveRequest>());
}

// Whatever waits to be written counts too, however new the rest is.
TEST_F(RecorderLoopBench, TellsTheAgeOfTheOldestRecordThatWaitsAsTheLogsBacklog) {
  Decision decision;
  decision.worst = static_cast<std::uint8_t>(safety::Hazard::None);
  std::int64_t most_ms = 0;
  for (int n = 0; n < 30; ++n) {
    if (n == 4) decision.stop = StopCategory::C2Hold;  // a record that may wait for others
    fake_bus::put(decision);
    fake_bus::put(Measurement{});
    fake_bus::put(DriveRequest{});
    turn();
    for (const LogHealth& health : fake_bus::written<LogHealth>())
      if (n > 0) most_ms = std::max<std::int64_t>(most_ms, health.backlog_ms);
  }
  EXPECT_GE(most_ms, 10);
  EXPECT_LE(most_ms, 100);
}

TEST_F(RecorderLoopBench, NamesTheOperatorOfNow) {
  Health person;
  person.process = Process::Person;
  OperatorAct act;
  for (const char* name : {"Ada", "Grace"}) {
    ++person.seq, person.note = name;
    (void)after(person);
    ++act.token;
    const std::vector<Record> records = after(act);
    ASSERT_EQ(kinds(records), "operator act");
    EXPECT_EQ(json::parse(records[0].body)["operator"], name);
  }
  now_us += 600'000;  // their program falls silent
  turn(), turn();
  (void)news();
  ++act.token;
  const std::vector<Record> records = after(act);
  ASSERT_EQ(kinds(records), "operator act");
  EXPECT_EQ(json::parse(records[0].body)["operator"], "Grace") << "the last who was there";
}

TEST_F(RecorderLoopBench, TellsTheAgeOfTheOldestTopicAsTheLogsBacklog) {
  for (int n = 0; n < 10; ++n) turn();
  std::vector<LogHealth> sent = fake_bus::written<LogHealth>();
  ASSERT_EQ(sent.size(), 2U);
  EXPECT_EQ(sent.back().backlog_ms, INT32_MAX) << "nothing was received yet";
  const std::uint32_t first = sent.back().seq;
  Decision decision;
  decision.worst = static_cast<std::uint8_t>(safety::Hazard::None);
  for (std::size_t silent = 0; silent < 3; ++silent) {
    fake_bus::written<LogHealth>();
    for (int n = 0; n < 30; ++n) {
      if (silent != 0 || n < 5) fake_bus::put(decision);
      if (silent != 1 || n < 5) fake_bus::put(Measurement{});
      if (silent != 2 || n < 5) fake_bus::put(DriveRequest{});
      turn();
    }
    sent = fake_bus::written<LogHealth>();
    ASSERT_EQ(sent.size(), 6U) << "every 50 ms";
    EXPECT_EQ(sent.front().backlog_ms, 0) << silent;
    EXPECT_EQ(sent.back().backlog_ms, 240)
        << silent << ": from the fifth turn to the 29th, the last that reports";
  }
  EXPECT_EQ(sent.back().seq, first + 18);
  EXPECT_EQ(sent.back().records, log.written().count);
}

}  // namespace
}  // namespace biopsy::loops_tests
