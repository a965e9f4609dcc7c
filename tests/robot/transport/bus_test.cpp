#include "robot/transport/bus.hpp"

#include <dds/dds.h>
#include <gtest/gtest.h>

#include <chrono>
#include <set>
#include <thread>

#include "robot/common/config_error.hpp"
#include "robot/msg/messages.hpp"
#include "robot/msg/wire_types.hpp"
#include "robot/security/cyclone_xml.hpp"

namespace biopsy::transport {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kDomain = 71;  // of this test alone

// One domain a process: every test uses this participant.
const Participant& bus() {
  static const Participant participant({kDomain, security::cyclone_xml({}), 1});
  return participant;
}

// Waits, never longer than it must.
template <class Condition>
bool soon(const Condition& condition) {
  const auto until = std::chrono::steady_clock::now() + 10s;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::yield();
  }
  return true;
}

TEST(Bus, DeliversInOrderAndWakesTheWaitSet) {
  Writer<Measurement> writer(bus());
  Reader<Measurement> reader(bus());
  WaitSet wait_set(bus());
  wait_set.add(reader);
  ASSERT_TRUE(soon([&] { return writer.readers() == 1 && reader.writers() == 1; }));
  for (std::uint32_t seq = 1; seq <= 5; ++seq) {
    Measurement m;
    m.seq = seq;
    m.depth_um = static_cast<std::int32_t>(seq) * 100;
    EXPECT_TRUE(writer.write(m));
  }
  EXPECT_TRUE(wait_set.wait(5s));
  Measurement got;
  for (std::uint32_t seq = 1; seq <= 5; ++seq) {
    ASSERT_TRUE(soon([&] { return reader.take(got); }));
    EXPECT_EQ(got.seq, seq);
    EXPECT_EQ(got.depth_um, static_cast<std::int32_t>(seq) * 100);
  }
  EXPECT_FALSE(reader.take(got));
  EXPECT_FALSE(wait_set.wait(0ns));
}

TEST(Bus, CountsWriters) {
  Reader<DriveRequest> reader(bus());
  EXPECT_EQ(reader.writers(), 0);
  Writer<DriveRequest> first(bus());
  ASSERT_TRUE(soon([&] { return reader.writers() == 1; }));
  {
    Writer<DriveRequest> second(bus());
    EXPECT_TRUE(soon([&] { return reader.writers() == 2; }));
  }
  EXPECT_TRUE(soon([&] { return reader.writers() == 1; }));
}

// It comes, writes and goes while the reader does something else: the count of writers alone never shows it.
TEST(Bus, CountsASecondWriterThatWasThereBetweenTwoReadings) {
  Reader<DepthVerdictNote> reader(bus());
  Writer<DepthVerdictNote> first(bus());
  DepthVerdictNote note;
  ASSERT_TRUE(soon([&] { return first.readers() == 1 && reader.writers() == 1; }));
  first.write({.seq = 1});
  ASSERT_TRUE(soon([&] { return reader.take(note); }));
  EXPECT_EQ(reader.writers(), 1);
  {
    Writer<DepthVerdictNote> second(bus());
    ASSERT_TRUE(soon([&] { return second.readers() == 1; }));
    second.write({.seq = 2, .accepted = true});
  }
  ASSERT_TRUE(soon([&] {  // the reader has learnt that it is gone, and was not asked
    dds_subscription_matched_status_t status{};
    dds_get_subscription_matched_status(reader.handle(), &status);
    return status.current_count == 1U;
  }));
  EXPECT_FALSE(reader.take(note)) << "and nobody acts on it";
  EXPECT_EQ(reader.writers(), 2) << "it wrote";
  EXPECT_EQ(reader.writers(), 1) << "and is gone";
}

// Reported: a rogue's act was logged as the operator's, because only the count of writers was looked at.
TEST(Bus, GivesNothingOfASecondWriterWhileTheFirstIsThere) {
  Reader<OperatorAct> reader(bus());
  Writer<OperatorAct> first(bus());
  OperatorAct act;
  ASSERT_TRUE(soon([&] { return first.readers() == 1; }));
  first.write({.seq = 1});
  ASSERT_TRUE(soon([&] { return reader.take(act); }));
  Writer<OperatorAct> second(bus());
  ASSERT_TRUE(soon([&] { return second.readers() == 1; }));
  for (std::uint32_t seq = 2; seq < 20; ++seq) {
    second.write({.seq = 1'000 + seq});
    first.write({.seq = seq});
    ASSERT_TRUE(soon([&] { return reader.take_newest(act) > 0; }));
    EXPECT_EQ(act.seq, seq);
  }
}

TEST(Bus, GivesTheHealthOfEachProcess) {
  Reader<Health> reader(bus());
  Writer<Health> stage(bus()), controller(bus());
  ASSERT_TRUE(soon([&] { return stage.readers() == 1 && controller.readers() == 1; }));
  Health of_stage, of_controller, health;
  of_stage.process = Process::Stage, of_controller.process = Process::Controller;
  std::set<Process> seen;
  EXPECT_TRUE(soon([&] {
    stage.write(of_stage), controller.write(of_controller);
    while (reader.take(health)) seen.insert(health.process);
    return seen.size() == 2;
  }));
}

TEST(Bus, TakesAWriterThatFollowsOneThatWentForTheOnlyOne) {
  Reader<DepthVerdictNote> reader(bus());
  DepthVerdictNote note;
  for (std::uint32_t seq = 1; seq <= 3; ++seq) {
    Writer<DepthVerdictNote> writer(bus());
    ASSERT_TRUE(soon([&] { return writer.readers() == 1 && reader.writers() == 1; }));
    writer.write({.seq = seq});
    ASSERT_TRUE(soon([&] { return reader.take(note) && note.seq == seq; }));
    EXPECT_EQ(reader.writers(), 1) << seq;
  }
}

TEST(Bus, GivesALateJoinerThePlan) {
  Writer<SealedPlan> writer(bus());
  SealedPlan plan;
  plan.bytes.assign(50'000, 42);
  plan.seal[0] = 7;
  plan.confirmed_tag = {1, 2};
  ASSERT_TRUE(writer.write(plan));
  Reader<SealedPlan> reader(bus());
  SealedPlan got;
  ASSERT_TRUE(soon([&] { return reader.take(got); }));
  EXPECT_EQ(got.bytes, plan.bytes);
  EXPECT_EQ(got.seal, plan.seal);
  EXPECT_EQ(got.confirmed_tag, plan.confirmed_tag);
}

TEST(Bus, IgnoresMessagesOfAnotherRobot) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_liveliness(qos, DDS_LIVELINESS_MANUAL_BY_TOPIC, DDS_MSECS(20));
  dds_qset_deadline(qos, DDS_MSECS(10));
  const Entity topic(
      dds_create_topic(bus().handle(), &WireType<Permit>::descriptor(), "Permit", nullptr, nullptr), "topic");
  const Entity other(dds_create_writer(bus().handle(), topic.handle(), qos, nullptr), "writer");
  dds_delete_qos(qos);
  Writer<Permit> writer(bus());
  Reader<Permit> reader(bus());
  ASSERT_TRUE(soon([&] { return reader.writers() == 2; }));
  for (const std::uint32_t robot : {bus().robot() + 1, bus().robot()}) {
    biopsy_wire_Permit sample{};
    sample.robot = robot;
    sample.seq = 10 + robot;
    ASSERT_EQ(dds_write(other.handle(), &sample), DDS_RETCODE_OK);
  }
  Permit got;
  ASSERT_TRUE(soon([&] { return reader.take(got); }));
  EXPECT_EQ(got.seq, 10 + bus().robot());
}

TEST(Bus, DetectsAWriterThatStopped) {
  Writer<Permit> writer(bus());
  Reader<Permit> reader(bus());
  ASSERT_TRUE(soon([&] { return reader.writers() == 1; }));
  writer.write({});
  ASSERT_TRUE(soon([&] { return reader.alive_writers() == 1; }));
  EXPECT_TRUE(soon([&] { return reader.alive_writers() == 0; }));  // its lease is 20 ms
}

TEST(Bus, RefusesAnInvalidConfiguration) {
  EXPECT_THROW(Participant({kDomain + 1, "<CycloneDDS><Nonsense>1</Nonsense></CycloneDDS>", 1}), ConfigError);
}

}  // namespace
}  // namespace biopsy::transport
