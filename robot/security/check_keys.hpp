// Checks the keys before a process starts: what the bus would refuse without a message, or accept although it
// is unsafe, is reported with the file's name.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robot/security/grants.hpp"
#include "robot/security/key_files.hpp"

namespace biopsy::security {

struct FileVerdict {
  std::filesystem::path file;
  std::string subject;  // of a certificate; what the file is, otherwise
  std::optional<std::chrono::sys_seconds> until;
  std::string problem;  // empty: good
  std::string remedy;
};

// Every file of a role: present, readable, private to its owner, within its validity, signed by its CA,
// unaltered, for this role, and granting exactly what this build grants. A file that depends on a bad one is
// bad as well.
std::vector<FileVerdict> inspect_keys(const std::filesystem::path& folder, Role role,
                                      std::chrono::sys_seconds now);
std::vector<FileVerdict> inspect_signing_keys(const std::filesystem::path& folder, Signer signer);

void throw_first_problem(const std::vector<FileVerdict>& verdicts);

// Throws ConfigError with the first problem; returns the time until which the keys are good.
std::chrono::sys_seconds check_keys(const std::filesystem::path& folder, Role role,
                                    std::chrono::sys_seconds now);
void check_signing_keys(const std::filesystem::path& folder, Signer signer);

}  // namespace biopsy::security
