#include "robot/security/cyclone_xml.hpp"

#include <gtest/gtest.h>

#include "robot/common/config_error.hpp"

namespace biopsy::security {
namespace {

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(CycloneXml, WithoutAnInterfaceNothingLeavesTheMachine) {
  const std::string xml = cyclone_xml({});
  EXPECT_TRUE(holds(xml, R"(<NetworkInterface name="lo" multicast="false"/>)"));
  EXPECT_TRUE(holds(xml, "<AllowMulticast>false</AllowMulticast>"));
  EXPECT_TRUE(holds(xml, "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"));
  EXPECT_FALSE(holds(xml, "<Security>"));
  EXPECT_FALSE(holds(xml, "ExternalDomainId"));
}

TEST(CycloneXml, AnInterfaceIsNamedAndOnlyDiscoveryIsMulticast) {
  const std::string xml = cyclone_xml({.interface = "eth1", .security = {}, .domain_on_wire = 7});
  EXPECT_TRUE(holds(xml, R"(<NetworkInterface name="eth1"/>)"));
  EXPECT_TRUE(holds(xml, "<AllowMulticast>spdp</AllowMulticast>"));
  EXPECT_TRUE(holds(xml, "<ExternalDomainId>7</ExternalDomainId>"));
  EXPECT_FALSE(holds(xml, "127.0.0.1"));
}

TEST(CycloneXml, SecurityNamesTheFilesOfTheRoleByTheirWholePath) {
  const std::string xml =
      cyclone_xml({.interface = {}, .security = Security{"keys", Role::Stage}, .domain_on_wire = {}});
  const std::string base = "file:" + (std::filesystem::current_path() / "keys/stage/").string();
  for (const char* name : {"identity_ca.pem", "permissions_ca.pem", "identity.pem", "identity_key.pem",
                           "governance.p7s", "permissions.p7s"})
    EXPECT_TRUE(holds(xml, ">" + base + name + "<")) << name;
}

TEST(CycloneXml, EachFileStandsInItsOwnElement) {
  const std::string xml =
      cyclone_xml({.interface = {}, .security = Security{"/keys", Role::Stage}, .domain_on_wire = {}});
  for (const auto& [element, name] : {std::pair{"IdentityCA", "identity_ca.pem"},
                                      {"PermissionsCA", "permissions_ca.pem"},
                                      {"IdentityCertificate", "identity.pem"},
                                      {"PrivateKey", "identity_key.pem"},
                                      {"Governance", "governance.p7s"},
                                      {"Permissions", "permissions.p7s"}})
    EXPECT_TRUE(holds(xml, std::string("<") + element + ">file:/keys/stage/" + name + "</")) << element;
}

TEST(CycloneXml, ValuesCannotBecomeElements) {
  const std::string xml = cyclone_xml(
      {.interface = "</General>&'", .security = Security{"/a<b>&c", Role::Stage}, .domain_on_wire = {}});
  EXPECT_TRUE(holds(xml, "name=\"&lt;/General&gt;&amp;&apos;\""));
  EXPECT_TRUE(holds(xml, "file:/a&lt;b&gt;&amp;c/stage/"));
}

TEST(CycloneXml, WhatCycloneWouldReadOtherwiseIsRefused) {
  for (const char* name : {"/a${HOME}", "/a\nb", "/a\"b", "/a\\b", "/a\x01"})
    EXPECT_THROW(
        cyclone_xml({.interface = {}, .security = Security{name, Role::Stage}, .domain_on_wire = {}}),
        ConfigError)
        << name;
}

}  // namespace
}  // namespace biopsy::security
