#include "robot/security/check_keys.hpp"

#include <openssl/pem.h>
#include <unistd.h>

#include "robot/security/key_set.hpp"
#include "tests/robot/security/check_keys_bench.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::security {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> all_files(const RoleFiles& files) {
  return {files.identity_ca, files.permissions_ca, files.identity,
          files.private_key, files.governance,     files.permissions};
}

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

}  // namespace
}  // namespace biopsy::security
