#include "robot/transport/bus.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "robot/common/config_error.hpp"
#include "robot/msg/messages.hpp"
#include "robot/msg/topics.hpp"
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

TEST(Bus, DeliversInOrderAndWakesTheReader) {
  Writer<Measurement> writer(bus());
  Reader<Measurement> reader(bus());
  Waker waker(bus());
  waker.add(reader);
  ASSERT_TRUE(soon([&] { return writer.readers() == 1 && reader.writers() == 1; }));
  for (std::uint32_t seq = 1; seq <= 5; ++seq) {
    Measurement m;
    m.seq = seq;
    m.depth_um = static_cast<std::int32_t>(seq) * 100;
    EXPECT_TRUE(writer.write(m));
  }
  EXPECT_TRUE(waker.wait(5s));
  Measurement got;
  for (std::uint32_t seq = 1; seq <= 5; ++seq) {
    ASSERT_TRUE(soon([&] { return reader.take(got); }));
    EXPECT_EQ(got.seq, seq);
    EXPECT_EQ(got.depth_um, static_cast<std::int32_t>(seq) * 100);
  }
  EXPECT_FALSE(reader.take(got));
  EXPECT_FALSE(waker.wait(0ns));
}

TEST(Bus, CountsWritersSoThatASecondOneIsSeen) {
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

TEST(Bus, TellsALateJoinerThePlan) {
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

TEST(Bus, HearsOfItsOwnRobotOnly) {
  Writer<Permit> writer(bus());
  Reader<Permit> reader(bus());
  ASSERT_TRUE(soon([&] { return reader.writers() == 1; }));
  Permit permit;
  permit.seq = 3;
  ASSERT_TRUE(writer.write(permit));
  Permit got;
  ASSERT_TRUE(soon([&] { return reader.take(got); }));
  EXPECT_EQ(got.seq, 3U);
}

TEST(Bus, NoticesAWriterThatStandsStill) {
  Writer<Permit> writer(bus());
  Reader<Permit> reader(bus());
  ASSERT_TRUE(soon([&] { return reader.writers() == 1; }));
  writer.write({});
  ASSERT_TRUE(soon([&] { return reader.alive_writers() == 1; }));
  EXPECT_TRUE(soon([&] { return reader.alive_writers() == 0; }));  // its lease is 20 ms
}

TEST(Bus, RefusesAConfigurationThatIsNone) {
  EXPECT_THROW(Participant({kDomain + 1, "<CycloneDDS><Nonsense>1</Nonsense></CycloneDDS>", 1}), ConfigError);
}

}  // namespace
}  // namespace biopsy::transport
