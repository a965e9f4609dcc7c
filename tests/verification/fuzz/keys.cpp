// Any bytes in the place of each file of a role's keys: a problem with a remedy, never worse, never good.
#include <chrono>

#include "robot/security/check_keys.hpp"
#include "robot/security/key_files.hpp"
#include "tests/robot/security/test_key_set.hpp"
#include "tests/verification/fuzz/target.hpp"

FUZZ(keys) {
  using namespace biopsy;
  using namespace biopsy::fuzz;
  static const security::TestKeySet set;
  if (bytes.empty()) return;
  const security::RoleFiles files = security::role_files(set.folder(), security::Role::Stage);
  const std::filesystem::path all[] = {files.identity_ca, files.permissions_ca, files.identity,
                                       files.private_key, files.governance,     files.permissions};
  const std::filesystem::path& file = all[bytes[0] % std::size(all)];
  const std::string whole = file_content(file);
  write_content(file, text_of(bytes.subspan(1)));
  const auto verdicts = security::inspect_keys(set.folder(), security::Role::Stage, security::now());
  const bool refused = std::ranges::any_of(verdicts, [](const auto& v) { return !v.problem.empty(); });
  write_content(file, whole);
  claim(refused, "a file that is not the set's own is a problem");
}
