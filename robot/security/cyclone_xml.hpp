// The whole configuration of Cyclone DDS 0.10 for one domain, for dds_create_domain(id, xml). With it no
// environment variable is read, so that none can turn security off.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "robot/security/key_files.hpp"

namespace biopsy::security {

struct Security {
  std::filesystem::path folder;  // a set of keys
  Role role;
};

struct CycloneOptions {
  std::string interface;               // name of a network interface; empty: this machine only (loopback)
  std::optional<Security> security;    // nothing: no authentication, no encryption
  std::optional<RoleFiles> enclave{};  // instead of `security`: files of a keystore that is not ours
  std::optional<int> domain_on_wire;   // 0 to 230, where it differs from the id given to dds_create_domain:
                                       // two roles in one process
};

// Reads no file: see check_keys. Throws ConfigError for a name that cannot stand in a configuration.
std::string cyclone_xml(const CycloneOptions& options);

}  // namespace biopsy::security
