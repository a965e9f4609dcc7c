// The keys at work: participants of the real Cyclone DDS on the loopback interface.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>

#include "robot/security/certificates.hpp"
#include "robot/security/key_files.hpp"
#include "robot/security/signed_text.hpp"
#include "tests/robot/security/bus_probe.hpp"
#include "tests/robot/security/test_key_set.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::security {
namespace {

namespace fs = std::filesystem;

TEST(Bus, TheControllerSpeaksAndTheStageHears) {
  const TestKeySet set;
  BusProbe stage(211, Security{set.folder(), Role::Stage});
  BusProbe controller(211, Security{set.folder(), Role::Controller});
  ASSERT_TRUE(stage.is_up()) << dds_strretcode(stage.participant_error());
  ASSERT_TRUE(controller.is_up()) << dds_strretcode(controller.participant_error());
  ASSERT_GT(stage.open_reader(kTopic<DriveRequest>.name), 0);
  ASSERT_GT(controller.open_writer(kTopic<DriveRequest>.name), 0);
  ASSERT_TRUE(controller.meets_a_reader());
  EXPECT_TRUE(controller.write(42));
  EXPECT_EQ(stage.next(), 42);
}

TEST(Bus, EachRoleMayOpenExactlyTheWritersOfTheTableAndEveryReader) {
  verifies("R-46");
  const TestKeySet set;
  for (const Role role : kRoles) {
    BusProbe probe(212, Security{set.folder(), role});
    ASSERT_TRUE(probe.is_up());
    for (const Topic& topic : kTopics) {
      EXPECT_EQ(probe.open_writer(topic.name) > 0, topic.writers.contains(role))
          << name_of(role) << " writes " << topic.name;
      EXPECT_GT(probe.open_reader(topic.name), 0) << name_of(role) << " reads " << topic.name;
    }
    EXPECT_LT(probe.open_writer("Invented"), 0);
    EXPECT_LT(probe.open_reader("Invented"), 0);
  }
}

// The secure pair starts last and shakes hands, which takes longer than finding a plain participant: what it
// has not heard when its own message arrives, it does not hear.
TEST(Bus, APlainParticipantNeitherHearsNorIsHeard) {
  verifies("R-46");
  const TestKeySet set;
  BusProbe plain_writer(213, std::nullopt), plain_reader(213, std::nullopt);
  ASSERT_GT(plain_writer.open_writer(kTopic<DriveRequest>.name), 0);
  ASSERT_GT(plain_reader.open_reader(kTopic<DriveRequest>.name), 0);
  ASSERT_TRUE(plain_writer.meets_a_reader());
  plain_writer.write(666);
  BusProbe stage(213, Security{set.folder(), Role::Stage});
  ASSERT_GT(stage.open_reader(kTopic<DriveRequest>.name), 0);
  BusProbe controller(213, Security{set.folder(), Role::Controller});
  ASSERT_GT(controller.open_writer(kTopic<DriveRequest>.name), 0);
  ASSERT_TRUE(controller.meets_a_reader());
  plain_writer.write(667);
  ASSERT_TRUE(controller.write(1));
  EXPECT_EQ(stage.next(), 1);
  EXPECT_EQ(stage.next(0), std::nullopt);
  EXPECT_EQ(stage.writers_met(), 1);
  EXPECT_EQ(controller.readers_met(), 1);
  EXPECT_EQ(plain_writer.readers_met(), 1);
  EXPECT_EQ(plain_reader.next(), 666);
  EXPECT_EQ(plain_reader.next(), 667);
  EXPECT_EQ(plain_reader.next(0), std::nullopt);
}

// What an intruder says before the true controller is met must not be there when the latter has been heard.
void expect_only_the_true_controller(int domain, const Security& intruder_keys, const fs::path& folder) {
  BusProbe stage(domain, Security{folder, Role::Stage});
  ASSERT_GT(stage.open_reader(kTopic<DriveRequest>.name), 0);
  BusProbe intruder(domain, intruder_keys);
  ASSERT_TRUE(intruder.is_up()) << "its own files agree with each other";
  ASSERT_GT(intruder.open_writer(kTopic<DriveRequest>.name), 0);
  intruder.write(666);
  for (std::int32_t round = 0; round < 3;
       ++round) {  // each a whole handshake, which the intruder had as well
    BusProbe controller(domain, Security{folder, Role::Controller});
    ASSERT_GT(controller.open_writer(kTopic<DriveRequest>.name), 0);
    ASSERT_TRUE(controller.meets_a_reader());
    intruder.write(667);
    ASSERT_TRUE(controller.write(round));
    EXPECT_EQ(stage.next(), round);
  }
  EXPECT_EQ(stage.next(0), std::nullopt);
  EXPECT_EQ(intruder.readers_met(), 0);
}

TEST(Bus, AnIdentityOfAnotherCaIsRefused) {
  verifies("R-46");
  const TestKeySet ours, theirs;
  expect_only_the_true_controller(214, {theirs.folder(), Role::Controller}, ours.folder());
}

// It opens the writer, since its own copy of the plugin believes it; the others do not.
TEST(Bus, AnObserverWithPermissionsOfItsOwnMakingIsRefused) {
  const TestKeySet set;
  const RoleFiles files = role_files(set.folder(), Role::Observer);
  const Validity times = *validity(read_certificate(file_content(files.identity)).get());
  const Key key = new_p256_key();
  const Certificate ca = new_ca("permissions CA", key.get(), CaPurpose::SignsDocuments, times);
  std::string granted = permissions_xml(Role::Controller, times);
  for (const std::string& name : {std::string("CN=controller"), std::string("\"controller\"")})
    granted.replace(granted.find(name), name.size(), name[0] == 'C' ? "CN=observer" : "\"observer\"");
  write_content(files.permissions_ca, pem(ca.get()));
  write_content(files.governance, sign_text(governance_xml(), ca.get(), key.get()));
  write_content(files.permissions, sign_text(granted, ca.get(), key.get()));
  expect_only_the_true_controller(215, {set.folder(), Role::Observer}, set.folder());
}

TEST(Bus, ParticipantsWithoutGoodFilesDoNotComeUp) {
  const TestKeySet set;
  const RoleFiles files = role_files(set.folder(), Role::Stage);
  fs::copy_file(role_files(set.folder(), Role::Controller).permissions, files.permissions,
                fs::copy_options::overwrite_existing);
  EXPECT_FALSE(BusProbe(216, Security{set.folder(), Role::Stage}).is_up()) << "permissions of another role";
  fs::remove(files.permissions);
  EXPECT_FALSE(BusProbe(216, Security{set.folder(), Role::Stage}).is_up()) << "no permissions";
  EXPECT_FALSE(BusProbe(216, Security{set.folder() / "nowhere", Role::Stage}).is_up()) << "no folder";
  const TestKeySet old(now() - std::chrono::days(10), 5);
  EXPECT_FALSE(BusProbe(216, Security{old.folder(), Role::Stage}).is_up()) << "expired";
}

TEST(Bus, KeysAreFoundInAFolderWithAnAwkwardName) {
  const ScratchFolder scratch;
  const fs::path folder = scratch / "a $HOME & <b> 'c', é";
  make_keys(folder, 30, now(), false);
  EXPECT_TRUE(BusProbe(217, Security{folder, Role::Stage}).is_up());
}

TEST(Bus, ALackingEnvironmentCannotTurnSecurityOff) {
  const TestKeySet set;
  setenv("CYCLONEDDS_URI", "<CycloneDDS><Domain><Security/></Domain></CycloneDDS>", 1);
  BusProbe stage(218, Security{set.folder(), Role::Stage});
  unsetenv("CYCLONEDDS_URI");
  ASSERT_TRUE(stage.is_up());
  EXPECT_LT(stage.open_writer(kTopic<DriveRequest>.name), 0);
}

TEST(Bus, TwoSecureParticipantsMeetInTime) {
  const TestKeySet set;
  const auto started = std::chrono::steady_clock::now();
  BusProbe stage(219, Security{set.folder(), Role::Stage});
  BusProbe controller(219, Security{set.folder(), Role::Controller});
  stage.open_reader(kTopic<DriveRequest>.name);
  controller.open_writer(kTopic<DriveRequest>.name);
  ASSERT_TRUE(controller.meets_a_reader());
  const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  RecordProperty("discovery_ms", std::to_string(1e3 * took));
  std::printf("two secure participants from nothing to a match: %.0f ms\n", 1e3 * took);
  EXPECT_LT(took, 5.0);
}

}  // namespace
}  // namespace biopsy::security
