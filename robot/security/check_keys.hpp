// Looks through the keys before a process starts: whatever the bus would refuse without a word, or would
// accept although nobody should, is said here, with the file's name.
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

// Every file of a role: there, readable, closed to others, inside its time, signed by its CA, unchanged, for
// this role, and granting exactly what this build grants. A file that hangs on a bad one is bad as well.
std::vector<FileVerdict> inspect_keys(const std::filesystem::path& folder, Role role,
                                      std::chrono::sys_seconds now);
std::vector<FileVerdict> inspect_signing_keys(const std::filesystem::path& folder, Signer signer);

void refuse_the_first_problem(const std::vector<FileVerdict>& verdicts);

// Throws ConfigError with the first problem; returns the time until which the keys are good.
std::chrono::sys_seconds check_keys(const std::filesystem::path& folder, Role role,
                                    std::chrono::sys_seconds now);
void check_signing_keys(const std::filesystem::path& folder, Signer signer);

}  // namespace biopsy::security
