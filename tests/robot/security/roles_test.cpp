#include "robot/security/roles.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "robot/security/grants.hpp"

namespace biopsy::security {
namespace {

constexpr std::size_t writers_of(std::string_view topic) {
  std::size_t count = 0;
  for (const Role role : kRoles) count += may_write(role, topic) ? 1U : 0U;
  return count;
}

TEST(Roles, EveryCommandHasExactlyOneWriter) {
  for (const auto topic : {topic::kDriveRequest, topic::kPermit, topic::kDecision, topic::kMeasurement})
    EXPECT_EQ(writers_of(topic), 1U) << topic;
  EXPECT_TRUE(may_write(Role::Controller, topic::kDriveRequest));
  EXPECT_TRUE(may_write(Role::Supervisor, topic::kPermit));
}

TEST(Roles, AnObserverWritesNothing) {
  for (const TopicRule& rule : kTopicRules) EXPECT_FALSE(may_write(Role::Observer, rule.topic));
  EXPECT_EQ(permissions_xml(Role::Observer, {}).find("<publish>"), std::string::npos);
}

TEST(Roles, EveryTopicHasAWriterAndAnUnknownTopicNone) {
  for (const TopicRule& rule : kTopicRules) EXPECT_GE(writers_of(rule.topic), 1U) << rule.topic;
  EXPECT_EQ(writers_of("Invented"), 0U);
  EXPECT_EQ(writers_of("*"), 0U);
}

TEST(Roles, WhatIsGrantedIsNamedInFullAndTheRestDenied) {
  for (const Role role : kRoles) {
    const std::string xml = permissions_xml(role, {});
    EXPECT_EQ(xml.find('*'), std::string::npos);
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

// The last rule is for every topic, so that one that nobody thought of is encrypted.
TEST(Roles, OnlyTheFiveTopicsOfTheTickAreNotEncrypted) {
  const std::string xml = governance_xml();
  std::vector<std::string> open;
  std::size_t at = 0;
  while ((at = xml.find("<topic_expression>", at)) != std::string::npos) {
    at += std::string_view("<topic_expression>").size();
    const std::string topic = xml.substr(at, xml.find('<', at) - at);
    const std::size_t data = xml.find("<data_protection_kind>", at) + 22;
    const std::string kind = xml.substr(data, xml.find('<', data) - data);
    if (kind == "NONE")
      open.push_back(topic);
    else
      EXPECT_EQ(topic + kind, "*ENCRYPT");
  }
  EXPECT_EQ(open,
            (std::vector<std::string>{"Measurement", "DriveRequest", "Permit", "Decision", "StageTruth"}));
}

TEST(Roles, TimesAreWrittenInUtc) {
  using std::chrono::sys_seconds, std::chrono::seconds;
  EXPECT_EQ(utc_text(sys_seconds(seconds(1795285292))), "2026-11-21T18:21:32Z");
}

}  // namespace
}  // namespace biopsy::security
