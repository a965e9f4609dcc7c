// The two documents that the permissions CA signs (OMG DDS Security 1.1, 9.4). The same build always writes
// the same text, so a check compares whole texts and has nothing to interpret.
#pragma once

#include <chrono>
#include <string>

#include "robot/msg/topics.hpp"

namespace biopsy::security {

struct Validity {
  std::chrono::sys_seconds from, until;
  bool operator==(const Validity&) const = default;
};

// For every domain and topic: nobody unauthenticated, every message authenticated, every sample encrypted.
std::string governance_xml();

// Write: as roles.hpp says. Read: all of its topics. Everything else is denied.
std::string permissions_xml(Role role, const Validity& validity);

// What the certificate of a role names, as RFC 2253 writes it.
std::string subject_of(Role role);

// "2026-11-21T18:10:23Z"
std::string utc_text(std::chrono::sys_seconds time);

}  // namespace biopsy::security
