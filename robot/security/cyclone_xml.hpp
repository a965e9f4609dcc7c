// The whole configuration of Cyclone DDS 0.10 for one domain, to be given to dds_create_domain(id, xml):
// then no variable of the environment is read, so none that is missing can turn security off.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "robot/msg/topics.hpp"

namespace biopsy::security {

struct Security {
  std::filesystem::path folder;  // a set of keys
  Role role;
};

struct CycloneOptions {
  std::string interface;              // name of a network interface; empty: this machine only (loopback)
  std::optional<Security> security;   // nothing: no authentication, no encryption
  std::optional<int> domain_on_wire;  // where the id given to dds_create_domain is not the one to speak in:
                                      // two roles in one process (0 to 230)
};

// Reads no file: see check_keys. Throws ConfigError for a name that cannot stand in a configuration, or where
// the security plugins of Cyclone DDS are not installed.
std::string cyclone_xml(const CycloneOptions& options);

}  // namespace biopsy::security
