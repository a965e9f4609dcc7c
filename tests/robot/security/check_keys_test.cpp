#include "robot/security/check_keys.hpp"

#include <gtest/gtest.h>
#include <openssl/pem.h>
#include <unistd.h>

#include <functional>
#include <map>
#include <random>

#include "robot/common/config_error.hpp"
#include "robot/security/certificates.hpp"
#include "robot/security/key_set.hpp"
#include "robot/security/signed_text.hpp"
#include "tests/robot/security/test_key_set.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::security {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> all_files(const RoleFiles& files) {
  return {files.identity_ca, files.permissions_ca, files.identity,
          files.private_key, files.governance,     files.permissions};
}

// The first problem, as "file: problem"; empty where there is none.
std::string problem(const fs::path& folder, Role role) {
  try {
    check_keys(folder, role, now());
    return "";
  } catch (const ConfigError& error) {
    EXPECT_FALSE(error.remedy.empty());
    return fs::path(error.where).filename().string() + ": " + error.what_is_wrong;
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

  using Contents = std::map<fs::path, std::string>;
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

TEST_F(CheckKeys, AMissingFileIsNamed) {
  for (const fs::path& file : all_files(files_)) {
    fs::rename(file, file.string() + ".away");
    EXPECT_EQ(stage_problem(), file.filename().string() + ": is missing");
    fs::rename(file.string() + ".away", file);
  }
  EXPECT_EQ(stage_problem(), "");
  EXPECT_EQ(problem(set_.folder() / "nowhere", Role::Stage), "nowhere: is missing");
}

TEST_F(CheckKeys, AFileThatOthersMayReadIsRefused) {
  verifies("R-64");
  for (const fs::path& file : all_files(files_)) {
    for (const fs::perms bit : {fs::perms::group_read, fs::perms::group_write, fs::perms::group_exec,
                                fs::perms::others_read, fs::perms::others_write, fs::perms::others_exec}) {
      fs::permissions(file, bit, fs::perm_options::add);
      EXPECT_TRUE(stage_problem().starts_with(file.filename().string() + ": is open to other users"));
      fs::permissions(file, bit, fs::perm_options::remove);
    }
  }
  fs::permissions(set_.folder(), fs::perms::group_write, fs::perm_options::add);
  EXPECT_EQ(stage_problem(), "keys: is open to other users (mode 0720)");
}

// In the folder of a role others may not even read: it holds a private key.
TEST_F(CheckKeys, ARolesFolderThatOthersMayOpenIsRefused) {
  const auto signing_problem = [this] {
    return inspect_signing_keys(set_.folder(), Signer::Recorder).front().problem;
  };
  for (const fs::perms bit : {fs::perms::group_read, fs::perms::group_exec, fs::perms::others_write}) {
    for (const fs::path& folder : {files_.identity.parent_path(),
                                   signing_files(set_.folder(), Signer::Recorder).private_key.parent_path()})
      fs::permissions(folder, bit, fs::perm_options::add);
    EXPECT_TRUE(stage_problem().starts_with("stage: is open to other users"));
    EXPECT_TRUE(signing_problem().starts_with("is open to other users"));
    for (const fs::path& folder : {files_.identity.parent_path(),
                                   signing_files(set_.folder(), Signer::Recorder).private_key.parent_path()})
      fs::permissions(folder, bit, fs::perm_options::remove);
  }
  EXPECT_EQ(stage_problem() + signing_problem(), "");
}

TEST_F(CheckKeys, CountFromTheirFirstSecondToTheirLast) {
  const auto problem_at = [this](std::chrono::sys_seconds at) {
    for (const FileVerdict& verdict : inspect_keys(set_.folder(), Role::Stage, at))
      if (verdict.file == files_.identity) return verdict.problem;
    return std::string("no identity");
  };
  const std::chrono::seconds one(1);
  EXPECT_EQ(problem_at(times().from), "");
  EXPECT_EQ(problem_at(times().until), "");
  EXPECT_TRUE(problem_at(times().from - one).starts_with("is not valid before"));
  EXPECT_TRUE(problem_at(times().until + one).starts_with("expired at"));
  EXPECT_EQ(check_keys(set_.folder(), Role::Stage, now()), times().until) << "the first that expires";
}

TEST_F(CheckKeys, AFileThatCannotBeReadIsNamed) {
  if (geteuid() == 0) {  // root may read every file: a folder in its place
    fs::remove(files_.identity);
    fs::create_directory(files_.identity);
    EXPECT_EQ(stage_problem(), "identity.pem: is not a key file");
    return;
  }
  fs::permissions(files_.identity, fs::perms::none);
  EXPECT_TRUE(stage_problem().starts_with("identity.pem: cannot be read"));
}

TEST_F(CheckKeys, IdentitiesMustBelongToTheRoleAndItsCa) {
  const TestKeySet other;
  const RoleFiles theirs = role_files(other.folder(), Role::Stage),
                  controller = role_files(set_.folder(), Role::Controller);
  const std::string not_signed = "identity.pem: is not signed by identity_ca.pem, or was altered",
                    not_a_ca = "identity_ca.pem: is not a CA certificate";
  const auto identity_of = [this](const RoleFiles& from) {
    return Contents{{files_.identity, file_content(from.identity)},
                    {files_.private_key, file_content(from.private_key)}};
  };
  EXPECT_EQ(problem_with(identity_of(theirs)), not_signed);
  EXPECT_EQ(problem_with(identity_of(controller)),
            "identity.pem: is for \"CN=controller,O=biopsy\", not for \"CN=stage,O=biopsy\"");
  const Key issuer_key = read_private_key(file_content(controller.private_key)), key = new_p256_key();
  const Certificate issuer = read_certificate(file_content(controller.identity));
  const auto issued = [&](Role role, EVP_PKEY* to) {
    return pem(new_identity(role, to, issuer.get(), issuer_key.get(), times()).get());
  };
  EXPECT_EQ(problem_with({{files_.identity, issued(Role::Stage, key.get())}}), not_signed);
  EXPECT_EQ(problem_with({{files_.identity_ca, pem(issuer.get())}}), not_a_ca);
  EXPECT_EQ(problem_with({{files_.identity_ca, issued(Role::Controller, issuer_key.get())}}), not_a_ca);
}

TEST_F(CheckKeys, APrivateKeyMustBelongToTheIdentityAndHaveNoPassPhrase) {
  const RoleFiles controller = role_files(set_.folder(), Role::Controller);
  EXPECT_EQ(problem_with({{files_.private_key, file_content(controller.private_key)}}),
            "identity_key.pem: does not belong to identity.pem, or was altered");
  const Key key = read_private_key(file_content(files_.private_key));
  const Bio locked = writer();
  ASSERT_EQ(PEM_write_bio_PKCS8PrivateKey(locked.get(), key.get(), EVP_aes_256_cbc(), "secret", 6, nullptr,
                                          nullptr),
            1);
  EXPECT_EQ(problem_with({{files_.private_key, written(locked)}}),
            "identity_key.pem: is not a private key, or was altered");
}

TEST_F(CheckKeys, DocumentsMustBeSignedByTheCaItself) {
  const TestKeySet other;
  const RoleFiles theirs = role_files(other.folder(), Role::Stage);
  const std::string not_signed = ": is not signed by permissions_ca.pem, or was altered";
  EXPECT_EQ(problem_with({{files_.permissions, file_content(theirs.permissions)}}),
            "permissions.p7s" + not_signed);
  EXPECT_EQ(problem_with({{files_.governance, file_content(theirs.governance)}}),
            "governance.p7s" + not_signed);
  const Key ca_key = read_private_key(file_content(ca_folder(set_.folder()) / "permissions_ca_key.pem"));
  const Certificate ca = read_certificate(file_content(files_.permissions_ca));
  const Key key = new_p256_key();
  const Certificate issued = new_identity(Role::Planner, key.get(), ca.get(), ca_key.get(), times());
  EXPECT_EQ(problem_with({{files_.permissions,
                           sign_text(permissions_xml(Role::Stage, times()), issued.get(), key.get())}}),
            "permissions.p7s" + not_signed);
}

TEST_F(CheckKeys, SignedDocumentsMustBeThoseOfThisBuildAndRole) {
  const std::string right = permissions_xml(Role::Stage, times());
  EXPECT_EQ(problem_with({{files_.permissions, signed_by_ca(right)}}), "");
  EXPECT_EQ(problem_with({{files_.permissions, signed_by_ca(permissions_xml(Role::Controller, times()))}}),
            "permissions.p7s: is for the controller, not for the stage");
  const auto changed = [](std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  };
  for (const std::string& wrong :
       {changed(right, "<topic>Measurement", "<topic>*"),
        changed(right, "<topic>Measurement", "<topic>DriveRequest</topic><topic>Measurement"),
        changed(right, "<topic>Measurement</topic>", ""), changed(right, "DENY", "ALLOW"),
        changed(right, "</not_before>", "</not_before><!-- -->"),
        changed(right, "<not_after>20", "<not_after>30"), right + " "})
    EXPECT_EQ(problem_with({{files_.permissions, signed_by_ca(wrong)}}),
              "permissions.p7s: differs from the permissions that this build grants the stage")
        << wrong;
  EXPECT_EQ(problem_with({{files_.governance,
                           signed_by_ca(changed(governance_xml(), "ENCRYPT</data", "NONE</data"))}}),
            "governance.p7s: differs from the governance of this build");
}

TEST_F(CheckKeys, ASigningKeyOfAnotherPairIsRefused) {
  const SigningFiles recorder = signing_files(set_.folder(), Signer::Recorder);
  const SigningFiles commissioning = signing_files(set_.folder(), Signer::Commissioning);
  write_content(recorder.public_key, file_content(commissioning.public_key));
  EXPECT_THROW(check_signing_keys(set_.folder(), Signer::Recorder), ConfigError);
  EXPECT_NO_THROW(check_signing_keys(set_.folder(), Signer::Commissioning));
}

TEST_F(CheckKeys, AFolderMixedOfTwoSetsIsRefused) {
  EXPECT_NO_THROW(check_set(set_.folder(), kRoles, now()));
  const TestKeySet other;
  fs::remove_all(set_.folder() / "controller");
  fs::copy(other.folder() / "controller", set_.folder() / "controller", fs::copy_options::recursive);
  fs::permissions(set_.folder() / "controller", fs::perms::owner_all);
  EXPECT_EQ(problem(set_.folder(), Role::Controller), "") << "valid by itself";
  try {
    check_set(set_.folder(), kRoles, now());
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_TRUE(error.where.ends_with("controller/identity_ca.pem"));
    EXPECT_EQ(error.what_is_wrong, "belongs to another set than stage/identity_ca.pem");
  }
}

TEST_F(CheckKeys, AMachineNeedsTheFoldersOfItsOwnRolesOnly) {
  for (const Role role : kRoles)
    if (role != Role::Stage && role != Role::Observer) fs::remove_all(set_.folder() / name_of(role));
  for (const char* folder : {"commissioning", "ca"}) fs::remove_all(set_.folder() / folder);
  const std::vector<Role> present = roles_present(set_.folder());
  EXPECT_EQ(present, (std::vector{Role::Stage, Role::Observer}));
  EXPECT_NO_THROW(check_set(set_.folder(), present, now()));
  EXPECT_THROW(check_set(set_.folder(), kRoles, now()), ConfigError);
  EXPECT_EQ(stage_problem(), "");
}

// What a file contains, read by other calls than the tested code uses.
using Meaning = std::function<std::string(const std::string&)>;

std::string der_of_pem(const std::string& content) {
  const Bio in(BIO_new_mem_buf(content.data(), static_cast<int>(content.size())));
  char* name = nullptr;
  char* header = nullptr;
  unsigned char* data = nullptr;
  long size = 0;
  if (PEM_read_bio(in.get(), &name, &header, &data, &size) != 1) return "";
  const std::string der(reinterpret_cast<char*>(data), static_cast<std::size_t>(size));
  OPENSSL_free(name);
  OPENSSL_free(header);
  OPENSSL_free(data);
  return der;
}

// The private scalar and the public point; the rest of PKCS #8 is encoding.
std::string key_numbers(const std::string& content) {
  const Bio in(BIO_new_mem_buf(content.data(), static_cast<int>(content.size())));
  const Key key(PEM_read_bio_PrivateKey(
      in.get(), nullptr, [](char*, int, int, void*) { return -1; }, nullptr));
  if (!key) return "";
  const Bio out = writer();
  EVP_PKEY_print_private(out.get(), key.get(), 0, nullptr);
  return written(out);
}

// The signed text without the S/MIME around it.
std::string signed_xml(const std::string& content) {
  const std::size_t from = content.find("<?xml"), to = content.find("</dds>");
  return from == std::string::npos || to == std::string::npos ? "" : content.substr(from, to - from);
}

// Over the whole length of a file: a flipped bit is detected, or does not change the contents.
void flip_bits(const fs::path& file, const Meaning& meaning, const std::function<bool()>& is_accepted) {
  const std::string good = file_content(file);
  const std::string meant = meaning(good);
  ASSERT_FALSE(meant.empty());
  std::mt19937 random(20261121);
  int found = 0;
  constexpr int kFlips = 150;
  for (int flip = 0; flip < kFlips; ++flip) {
    std::string bad = good;
    const std::size_t bit = std::uniform_int_distribution<std::size_t>(0, 8 * good.size() - 1)(random);
    bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << (bit % 8)));
    write_content(file, bad);
    if (is_accepted())
      EXPECT_EQ(meaning(bad), meant) << file << ": bit " << bit << " is not detected";
    else
      ++found;
  }
  write_content(file, good);
  EXPECT_GT(found, kFlips * 3 / 4) << file;
}

TEST_F(CheckKeys, AFlippedBitIsDetectedOrChangesNothing) {
  const auto stage_is_accepted = [this] { return stage_problem().empty(); };
  for (const fs::path& file : {files_.identity_ca, files_.permissions_ca, files_.identity})
    flip_bits(file, der_of_pem, stage_is_accepted);
  flip_bits(files_.private_key, key_numbers, stage_is_accepted);
  for (const fs::path& file : {files_.governance, files_.permissions})
    flip_bits(file, signed_xml, stage_is_accepted);
  for (const Signer signer : kSigners) {
    const SigningFiles files = signing_files(set_.folder(), signer);
    const auto is_accepted = [this, signer] {
      for (const FileVerdict& verdict : inspect_signing_keys(set_.folder(), signer))
        if (!verdict.problem.empty()) return false;
      return true;
    };
    flip_bits(files.private_key, key_numbers, is_accepted);
    flip_bits(files.public_key, der_of_pem, is_accepted);
  }
}

}  // namespace
}  // namespace biopsy::security
