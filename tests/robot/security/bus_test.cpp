// Participants of Cyclone DDS with the keys that are made, on the loopback interface.
#include <gtest/gtest.h>

#include <chrono>

#include "robot/security/certificates.hpp"
#include "robot/security/key_files.hpp"
#include "robot/security/signed_text.hpp"
#include "tests/robot/security/bus_probe.hpp"
#include "tests/robot/security/test_key_set.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::security {
namespace {

namespace fs = std::filesystem;

TEST(SecuredBus, DeliversFromControllerToStageWithinSecondsOfTheirStart) {
  const TestKeySet set;
  const auto started = std::chrono::steady_clock::now();
  BusProbe stage(211, Security{set.folder(), Role::Stage});
  BusProbe controller(211, Security{set.folder(), Role::Controller});
  ASSERT_TRUE(stage.is_up()) << dds_strretcode(stage.participant_error());
  ASSERT_TRUE(controller.is_up()) << dds_strretcode(controller.participant_error());
  ASSERT_GT(stage.open_reader(kTopic<DriveRequest>.name), 0);
  ASSERT_GT(controller.open_writer(kTopic<DriveRequest>.name), 0);
  ASSERT_TRUE(controller.matches_a_reader());
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  RecordProperty("discovery_ms", std::to_string(1e3 * took_s));
  EXPECT_LT(took_s, 5.0);
  EXPECT_TRUE(controller.write(42));
  EXPECT_EQ(stage.next(), 42);
}

TEST(SecuredBus, EachRoleOpensExactlyItsWritersAndEveryReader) {
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

// The secured pair starts last, and its handshake takes longer than the discovery of a plain participant:
// what it has not received when its own message arrives will not be received.
TEST(SecuredBus, AParticipantWithoutKeysIsIgnored) {
  verifies("R-46");
  const TestKeySet set;
  BusProbe plain_writer(213, std::nullopt), plain_reader(213, std::nullopt);
  ASSERT_GT(plain_writer.open_writer(kTopic<DriveRequest>.name), 0);
  ASSERT_GT(plain_reader.open_reader(kTopic<DriveRequest>.name), 0);
  ASSERT_TRUE(plain_writer.matches_a_reader());
  plain_writer.write(666);
  BusProbe stage(213, Security{set.folder(), Role::Stage});
  ASSERT_GT(stage.open_reader(kTopic<DriveRequest>.name), 0);
  BusProbe controller(213, Security{set.folder(), Role::Controller});
  ASSERT_GT(controller.open_writer(kTopic<DriveRequest>.name), 0);
  ASSERT_TRUE(controller.matches_a_reader());
  plain_writer.write(667);
  ASSERT_TRUE(controller.write(1));
  EXPECT_EQ(stage.next(), 1);
  EXPECT_EQ(stage.next(0), std::nullopt);
  EXPECT_EQ(stage.matched_writers(), 1);
  EXPECT_EQ(controller.matched_readers(), 1);
  EXPECT_EQ(plain_writer.matched_readers(), 1);
  EXPECT_EQ(plain_reader.next(), 666);
  EXPECT_EQ(plain_reader.next(), 667);
  EXPECT_EQ(plain_reader.next(0), std::nullopt);
}

// What an intruder wrote before the controller is matched must not be there when the controller's sample
// arrives.
void expect_only_the_controller(int domain, const Security& intruder_keys, const fs::path& folder) {
  BusProbe stage(domain, Security{folder, Role::Stage});
  ASSERT_GT(stage.open_reader(kTopic<DriveRequest>.name), 0);
  BusProbe intruder(domain, intruder_keys);
  ASSERT_TRUE(intruder.is_up()) << "its own files agree with each other";
  ASSERT_GT(intruder.open_writer(kTopic<DriveRequest>.name), 0);
  intruder.write(666);
  for (std::int32_t round = 0; round < 3;
       ++round) {  // each a complete handshake, as long as the intruder had
    BusProbe controller(domain, Security{folder, Role::Controller});
    ASSERT_GT(controller.open_writer(kTopic<DriveRequest>.name), 0);
    ASSERT_TRUE(controller.matches_a_reader());
    intruder.write(667);
    ASSERT_TRUE(controller.write(round));
    EXPECT_EQ(stage.next(), round);
  }
  EXPECT_EQ(stage.next(0), std::nullopt);
  EXPECT_EQ(intruder.matched_readers(), 0);
}

TEST(SecuredBus, AnIdentityOfAnotherCaIsRefused) {
  verifies("R-46");
  const TestKeySet ours, theirs;
  expect_only_the_controller(214, {theirs.folder(), Role::Controller}, ours.folder());
}

// It opens the writer, since its own plugin accepts the permissions; those of the others do not.
TEST(SecuredBus, ForgedPermissionsAreRefused) {
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
  expect_only_the_controller(215, {set.folder(), Role::Observer}, set.folder());
}

TEST(SecuredBus, ParticipantsWithoutValidFilesDoNotStart) {
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

TEST(SecuredBus, KeysAreFoundInAFolderWithSpecialCharacters) {
  const ScratchFolder scratch;
  const fs::path folder = scratch / "a $HOME & <b> 'c', é";
  make_keys(folder, 30, now(), false);
  EXPECT_TRUE(BusProbe(217, Security{folder, Role::Stage}).is_up());
}

TEST(SecuredBus, TheEnvironmentCannotTurnSecurityOff) {
  const TestKeySet set;
  setenv("CYCLONEDDS_URI", "<CycloneDDS><Domain><Security/></Domain></CycloneDDS>", 1);
  BusProbe stage(218, Security{set.folder(), Role::Stage});
  unsetenv("CYCLONEDDS_URI");
  ASSERT_TRUE(stage.is_up());
  EXPECT_LT(stage.open_writer(kTopic<DriveRequest>.name), 0);
}

}  // namespace
}  // namespace biopsy::security
