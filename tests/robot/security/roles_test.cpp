// Who may write what, and that the documents the bus enforces grant exactly that.
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "robot/msg/topics.hpp"
#include "robot/security/grants.hpp"
#include "robot/security/key_files.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::security {
namespace {

std::vector<Role> writers_of(const Topic& topic) {
  std::vector<Role> writers;
  for (const Role role : kRoles)
    if (topic.writers.contains(role)) writers.push_back(role);
  return writers;
}

TEST(Roles, PermissionsAreValidAsLongAsTheIdentity) {
  const Validity times{std::chrono::sys_seconds(std::chrono::seconds(1'000'000'000)),
                       std::chrono::sys_seconds(std::chrono::seconds(2'000'000'000))};
  for (const Role role : kRoles) {
    const std::string text = permissions_xml(role, times);
    EXPECT_NE(text.find("<not_before>2001-09-09T01:46:40Z</not_before>"), std::string::npos);
    EXPECT_NE(text.find("<not_after>2033-05-18T03:33:20Z</not_after>"), std::string::npos);
  }
}

TEST(Roles, EveryCommandHasExactlyOneWriter) {
  EXPECT_EQ(writers_of(kTopic<DriveRequest>), std::vector{Role::Controller});
  EXPECT_EQ(writers_of(kTopic<Permit>), std::vector{Role::Supervisor});
  EXPECT_EQ(writers_of(kTopic<Decision>), std::vector{Role::Supervisor});
  EXPECT_EQ(writers_of(kTopic<Measurement>), std::vector{Role::Stage});
}

TEST(Roles, TheConsoleCannotGiveASecondPersonsConfirmation) {
  verifies("R-69");
  EXPECT_EQ(writers_of(kTopic<PlanConfirmation>), (std::vector{Role::Planner, Role::Confirmer}));
  for (const Topic& topic : kTopics)
    EXPECT_EQ(topic.writers.contains(Role::Confirmer), topic.name == kTopic<PlanConfirmation>.name)
        << topic.name;
}

TEST(Roles, AnObserverWritesNothingAndEveryTopicHasAWriter) {
  for (const Topic& topic : kTopics) {
    EXPECT_FALSE(topic.writers.contains(Role::Observer)) << topic.name;
    EXPECT_FALSE(topic.writers.contains(Role::Mcap)) << topic.name;
    EXPECT_FALSE(writers_of(topic).empty()) << topic.name;
  }
}

// The topics between <element> and </element>.
std::set<std::string> topics_in(const std::string& xml, const std::string& element) {
  std::set<std::string> names;
  const std::size_t from = xml.find("<" + element + ">"), to = xml.find("</" + element + ">");
  if (from == std::string::npos) return names;
  const std::string part = xml.substr(from, to - from);
  const std::regex topic("<topic>([^<]*)</topic>");
  for (std::sregex_iterator match(part.begin(), part.end(), topic), end; match != end; ++match)
    names.insert((*match)[1]);
  return names;
}

TEST(Roles, PermissionsGrantExactlyTheTableAndDenyTheRest) {
  for (const Role role : kRoles) {
    const std::string xml = permissions_xml(role, {});
    std::set<std::string> writes, all;
    for (const Topic& topic : kTopics) {
      all.emplace(topic.name);
      if (topic.writers.contains(role)) writes.emplace(topic.name);
    }
    EXPECT_EQ(topics_in(xml, "publish"), writes) << name_of(role);
    EXPECT_EQ(topics_in(xml, "subscribe"), all) << name_of(role);
    EXPECT_NE(xml.find("<default>DENY</default>"), std::string::npos);
    EXPECT_NE(xml.find("<subject_name>CN=" + std::string(name_of(role)) + ",O=biopsy<"), std::string::npos);
  }
}

TEST(Roles, NothingGoesUnprotected) {
  const std::string xml = governance_xml();
  for (const char* line : {"<allow_unauthenticated_participants>false<", "<enable_join_access_control>true<",
                           "<discovery_protection_kind>ENCRYPT<", "<liveliness_protection_kind>ENCRYPT<",
                           "<rtps_protection_kind>SIGN<", "<topic_expression>*<",
                           "<enable_discovery_protection>true<", "<enable_liveliness_protection>true<",
                           "<enable_read_access_control>true<", "<enable_write_access_control>true<"})
    EXPECT_NE(xml.find(line), std::string::npos) << line;
  EXPECT_EQ(xml.find(">false<", xml.find("<topic_access_rules>")), std::string::npos);
}

// The last rule is for every topic, so that one without a rule of its own is encrypted.
TEST(Roles, OnlyTheFiveTopicsOfTheTickAreNotEncrypted) {
  const std::string xml = governance_xml();
  const std::regex rule("<topic_expression>([^<]*)<[^]*?<data_protection_kind>([^<]*)<");
  std::vector<std::string> kinds;
  for (std::sregex_iterator match(xml.begin(), xml.end(), rule), end; match != end; ++match)
    kinds.push_back((*match)[1].str() + " " + (*match)[2].str());
  EXPECT_EQ(kinds, (std::vector<std::string>{"Measurement NONE", "DriveRequest NONE", "Permit NONE",
                                             "Decision NONE", "StageTruth NONE", "* ENCRYPT"}));
}

TEST(Roles, TimesAreWrittenInUtc) {
  using std::chrono::sys_seconds, std::chrono::seconds;
  EXPECT_EQ(utc_text(sys_seconds(seconds(1795285292))), "2026-11-21T18:21:32Z");
}

}  // namespace
}  // namespace biopsy::security
