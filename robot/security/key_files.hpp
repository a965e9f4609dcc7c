// Where the files of a key set are: one folder per role with everything this role needs and nothing else, so
// that a process, user or machine gets that folder alone.
#pragma once

#include <array>
#include <filesystem>

#include "robot/msg/topics.hpp"

namespace biopsy::security {

inline constexpr std::array kRoles = all_values<Role>();

struct RoleFiles {
  std::filesystem::path identity_ca;     // certificate that signed every identity
  std::filesystem::path permissions_ca;  // certificate that signed governance and permissions
  std::filesystem::path identity;        // certificate of this role
  std::filesystem::path private_key;     // secret
  std::filesystem::path governance;      // which topics are protected, and how
  std::filesystem::path permissions;     // what this role may write and read
};
RoleFiles role_files(const std::filesystem::path& folder, Role role);

// Ed25519 pairs that sign the procedure log and the commissioning record.
enum class Signer : std::uint8_t { Recorder, Commissioning };
inline constexpr std::array kSigners{Signer::Recorder, Signer::Commissioning};

struct SigningFiles {
  std::filesystem::path private_key;  // secret
  std::filesystem::path public_key;
};
SigningFiles signing_files(const std::filesystem::path& folder, Signer signer);

// The private keys of both CAs. No program reads them: the folder may be moved off the machine.
std::filesystem::path ca_folder(const std::filesystem::path& folder);

// $XDG_CONFIG_HOME/biopsy/keys, or ~/.config/biopsy/keys. Throws ConfigError where neither is known.
std::filesystem::path default_folder();

}  // namespace biopsy::security
