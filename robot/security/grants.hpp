// The two documents that the permissions CA signs (OMG DDS Security 1.1, 9.4). A build always writes the same
// text, so a check compares whole texts.
#pragma once

#include <chrono>
#include <string>

#include "robot/msg/topics.hpp"

namespace biopsy::security {

struct Validity {
  std::chrono::sys_seconds from, until;
  bool operator==(const Validity&) const = default;
};

// For every domain and topic: authenticated participants only, every message signed, samples protected as
// bus.idl declares.
std::string governance_xml();

// Write: the topics whose @writers in bus.idl name the role. Read: every topic. Everything else is denied.
std::string permissions_xml(Role role, const Validity& validity);

// The subject of a role's certificate (RFC 2253).
std::string subject_of(Role role);

// "2026-11-21T18:10:23Z"
std::string utc_text(std::chrono::sys_seconds time);

}  // namespace biopsy::security
