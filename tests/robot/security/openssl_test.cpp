// The openssl command as an independent reader of the keys that are made, and as a maker of those that are
// checked.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>

#include "robot/security/certificates.hpp"
#include "robot/security/check_keys.hpp"
#include "robot/security/signed_text.hpp"
#include "tests/robot/security/test_key_set.hpp"

namespace biopsy::security {
namespace {

namespace fs = std::filesystem;

class OpenSsl : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("openssl version > /dev/null 2>&1") != 0) GTEST_SKIP() << "no openssl command";
  }
  bool runs(const std::string& arguments) const {
    const std::string command = "openssl " + arguments + " > '" + (scratch_ / "output").string() + "' 2>&1";
    return std::system(command.c_str()) == 0;
  }
  std::string output() const { return file_content(scratch_ / "output"); }

  const ScratchFolder scratch_;
  const TestKeySet set_;
};

std::string quoted(const fs::path& path) {
  return "'" + path.string() + "'";
}

TEST_F(OpenSsl, AcceptsEveryIdentityAndDocument) {
  for (const Role role : kRoles) {
    const RoleFiles files = role_files(set_.folder(), role);
    EXPECT_TRUE(
        runs("verify -x509_strict -CAfile " + quoted(files.identity_ca) + " " + quoted(files.identity)))
        << output();
    EXPECT_TRUE(runs("verify -x509_strict -CAfile " + quoted(files.permissions_ca) + " " +
                     quoted(files.permissions_ca)))
        << output();
    EXPECT_TRUE(runs("pkey -check -noout -in " + quoted(files.private_key))) << output();
    for (const char* tool : {"cms", "smime"})
      for (const fs::path& document : {files.governance, files.permissions})
        EXPECT_TRUE(runs(std::string(tool) + " -verify -text -in " + quoted(document) + " -CAfile " +
                         quoted(files.permissions_ca) + " -out " + quoted(scratch_ / "text")))
            << output();
    std::string text = file_content(scratch_ / "text");
    std::erase(text, '\r');
    EXPECT_EQ(text, permissions_xml(role, *validity(read_certificate(file_content(files.identity)).get())));
  }
}

TEST_F(OpenSsl, RefusesDocumentsAndIdentitiesOfAnotherSet) {
  const TestKeySet other;
  const RoleFiles ours = role_files(set_.folder(), Role::Stage),
                  theirs = role_files(other.folder(), Role::Stage);
  EXPECT_FALSE(runs("verify -CAfile " + quoted(ours.identity_ca) + " " + quoted(theirs.identity)));
  EXPECT_FALSE(runs("cms -verify -text -in " + quoted(theirs.permissions) + " -CAfile " +
                    quoted(ours.permissions_ca)));
}

TEST_F(OpenSsl, DocumentsItSignsAreAccepted) {
  const RoleFiles files = role_files(set_.folder(), Role::Stage);
  const Certificate ca = read_certificate(file_content(files.permissions_ca));
  scratch_.write("text", governance_xml());
  for (const char* tool : {"cms", "smime"}) {
    ASSERT_TRUE(runs(std::string(tool) + " -sign -text -in " + quoted(scratch_ / "text") + " -out " +
                     quoted(scratch_ / "signed") + " -signer " + quoted(files.permissions_ca) + " -inkey " +
                     quoted(ca_folder(set_.folder()) / "permissions_ca_key.pem")))
        << output();
    EXPECT_EQ(verify_text(file_content(scratch_ / "signed"), ca.get()), governance_xml());
  }
}

TEST_F(OpenSsl, VerifiesWhatASigningKeySigned) {
  for (const Signer signer : kSigners) {
    const SigningFiles files = signing_files(set_.folder(), signer);
    scratch_.write("message", "depth 3.5 mm");
    ASSERT_TRUE(runs("pkeyutl -sign -rawin -inkey " + quoted(files.private_key) + " -in " +
                     quoted(scratch_ / "message") + " -out " + quoted(scratch_ / "signature")))
        << output();
    EXPECT_TRUE(runs("pkeyutl -verify -rawin -pubin -inkey " + quoted(files.public_key) + " -in " +
                     quoted(scratch_ / "message") + " -sigfile " + quoted(scratch_ / "signature")))
        << output();
  }
}

}  // namespace
}  // namespace biopsy::security
