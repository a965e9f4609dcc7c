// A set of keys whose files a test changes, and what the checks then say.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "robot/common/config_error.hpp"
#include "robot/security/certificates.hpp"
#include "robot/security/check_keys.hpp"
#include "robot/security/signed_text.hpp"
#include "tests/robot/security/test_key_set.hpp"

namespace biopsy::security {

// The first problem, as "file: problem"; empty where there is none.
inline std::string problem(const std::filesystem::path& folder, Role role) {
  try {
    check_keys(folder, role, now());
    return "";
  } catch (const ConfigError& error) {
    EXPECT_FALSE(error.remedy.empty());
    return std::filesystem::path(error.where).filename().string() + ": " + error.what_is_wrong;
  }
}

class CheckKeys : public testing::Test {
 protected:
  std::string stage_problem() const { return problem(set_.folder(), Role::Stage); }
  // Signed by the CA of this set.
  std::string signed_by_ca(const std::string& text) const {
    const Key key = read_private_key(file_content(ca_folder(set_.folder()) / "permissions_ca_key.pem"));
    const Certificate ca = read_certificate(file_content(files_.permissions_ca));
    return sign_text(text, ca.get(), key.get());
  }
  Validity times() const { return *validity(read_certificate(file_content(files_.identity)).get()); }

  using Contents = std::map<std::filesystem::path, std::string>;
  // The problem when these files have other contents; the set is restored afterwards.
  std::string problem_with(const Contents& changed) const {
    Contents good;
    for (const auto& [file, content] : changed) {
      good[file] = file_content(file);
      write_content(file, content);
    }
    const std::string found = stage_problem();
    for (const auto& [file, content] : good) write_content(file, content);
    return found;
  }

  const TestKeySet set_;
  const RoleFiles files_ = role_files(set_.folder(), Role::Stage);
};

}  // namespace biopsy::security
