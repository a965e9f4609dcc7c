#include "robot/security/grants.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

namespace biopsy::security {
namespace {

// The parser of Cyclone DDS refuses a larger id than 230 (there are no ports for it either).
constexpr const char* kEveryDomain = "<domains><id_range><min>0</min><max>230</max></id_range></domains>";

std::string topic_list(const std::string& names) {
  return "<topics>" + names + "</topics>";
}

std::string named(std::string_view name) {
  return fmt::format("<topic>{}</topic>", name);
}

// The first rule whose expression matches a topic applies.
std::string protected_topic(std::string_view expression, std::string_view sample) {
  return fmt::format(
      R"(<topic_rule>
<topic_expression>{}</topic_expression>
<enable_discovery_protection>true</enable_discovery_protection>
<enable_liveliness_protection>true</enable_liveliness_protection>
<enable_read_access_control>true</enable_read_access_control>
<enable_write_access_control>true</enable_write_access_control>
<metadata_protection_kind>NONE</metadata_protection_kind>
<data_protection_kind>{}</data_protection_kind>
</topic_rule>
)",
      expression, sample);
}

}  // namespace

// Every RTPS message is signed: samples, headers, heartbeats and acknowledgements cannot be forged. Discovery
// and topics outside the tick, which may name a person, are encrypted as well. Codes per reader
// (WITH_ORIGIN_AUTHENTICATION) would keep a compromised reader from impersonating the writer it reads, but
// double the round trip with five processes: see docs/how-to/manage-keys.md.
std::string governance_xml() {
  std::string rules;
  for (const Topic& topic : kTopics)
    if (topic.protection == Protection::Signed) rules += protected_topic(topic.name, "NONE");
  rules += protected_topic("*", "ENCRYPT");
  return fmt::format(
      R"(<?xml version="1.0" encoding="UTF-8"?>
<dds>
<domain_access_rules><domain_rule>
{}
<allow_unauthenticated_participants>false</allow_unauthenticated_participants>
<enable_join_access_control>true</enable_join_access_control>
<discovery_protection_kind>ENCRYPT</discovery_protection_kind>
<liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
<rtps_protection_kind>SIGN</rtps_protection_kind>
<topic_access_rules>{}</topic_access_rules>
</domain_rule></domain_access_rules>
</dds>
)",
      kEveryDomain, rules);
}

std::string permissions_xml(Role role, const Validity& validity) {
  std::string written, read;
  for (const Topic& topic : kTopics) {
    if (topic.writers.contains(role)) written += named(topic.name);
    read += named(topic.name);
  }
  const std::string publish = written.empty() ? "" : "<publish>" + topic_list(written) + "</publish>\n";
  return fmt::format(
      R"(<?xml version="1.0" encoding="UTF-8"?>
<dds>
<permissions><grant name="{}">
<subject_name>{}</subject_name>
<validity><not_before>{}</not_before><not_after>{}</not_after></validity>
<allow_rule>
{}
{}<subscribe>{}</subscribe>
</allow_rule>
<default>DENY</default>
</grant></permissions>
</dds>
)",
      name_of(role), subject_of(role), utc_text(validity.from), utc_text(validity.until), kEveryDomain,
      publish, topic_list(read));
}

std::string subject_of(Role role) {
  return fmt::format("CN={},O=biopsy", name_of(role));
}

std::string utc_text(std::chrono::sys_seconds time) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}Z", fmt::gmtime(std::chrono::system_clock::to_time_t(time)));
}

}  // namespace biopsy::security
