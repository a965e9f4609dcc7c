// What the checks of the keys say of each file and folder, to the letter: what is wrong and what to do.
#include <fmt/format.h>
#include <openssl/err.h>
#include <sys/stat.h>
#include <unistd.h>

#include "robot/security/key_set.hpp"
#include "tests/robot/security/check_keys_bench.hpp"

namespace biopsy::security {
namespace {

namespace fs = std::filesystem;
using Problems = std::vector<std::string>;

const std::string kMakeNew = "make new keys: biopsy keys init --replace";

struct KeyVerdicts : CheckKeys {
  std::vector<FileVerdict> stage() const { return inspect_keys(set_.folder(), Role::Stage, now()); }
  std::vector<FileVerdict> signing() const { return inspect_signing_keys(set_.folder(), Signer::Recorder); }
  // Of a single verdict: "subject: problem; remedy".
  static std::string only(const std::vector<FileVerdict>& verdicts) {
    if (verdicts.size() != 1) return fmt::format("{} verdicts", verdicts.size());
    return verdicts[0].subject + ": " + verdicts[0].problem + "; " + verdicts[0].remedy;
  }
  // In the order of the files.
  static Problems problems(const std::vector<FileVerdict>& verdicts) {
    Problems all;
    for (const FileVerdict& verdict : verdicts) {
      EXPECT_EQ(verdict.problem.empty(), verdict.remedy.empty()) << verdict.file;
      all.push_back(verdict.problem);
    }
    return all;
  }
  // "problem; remedy" of the identity's certificate.
  std::string of_identity() const {
    const FileVerdict verdict = stage().at(2);
    EXPECT_EQ(verdict.file, files_.identity);
    return verdict.problem + "; " + verdict.remedy;
  }
  fs::path stage_folder() const { return files_.identity.parent_path(); }

  const SigningFiles recorder_ = signing_files(set_.folder(), Signer::Recorder);
};

TEST_F(KeyVerdicts, NameEveryFileWhatItIsAndUntilWhenItIsGood) {
  const std::vector<FileVerdict> all = stage();
  ASSERT_EQ(all.size(), 6U);
  const auto until = std::optional(times().until);
  const auto expect = [](const FileVerdict& verdict, const fs::path& file, const std::string& subject,
                         const std::optional<std::chrono::sys_seconds>& last) {
    EXPECT_EQ(verdict.file, file);
    EXPECT_EQ(verdict.subject.substr(0, subject.size()), subject);
    EXPECT_EQ(verdict.until, last) << file;
    EXPECT_EQ(verdict.problem + verdict.remedy, "");
  };
  expect(all[0], files_.identity_ca, "CN=identity CA ", until);
  expect(all[1], files_.permissions_ca, "CN=permissions CA ", until);
  expect(all[2], files_.identity, "CN=stage,O=biopsy", until);
  expect(all[3], files_.private_key, "private key", std::nullopt);
  expect(all[4], files_.governance, "governance", std::nullopt);
  expect(all[5], files_.permissions, "permissions of CN=stage,O=biopsy", until);
  const std::vector<FileVerdict> pair = signing();
  ASSERT_EQ(pair.size(), 2U);
  EXPECT_EQ(recorder_.private_key, set_.folder() / "recorder" / "signing_key.pem");
  expect(pair[0], recorder_.public_key, "public key", std::nullopt);
  expect(pair[1], recorder_.private_key, "signing key", std::nullopt);
}

TEST_F(KeyVerdicts, AFileThatDependsOnABadOneIsBadAsWell) {
  const auto without = [this](const fs::path& file) {
    fs::rename(file, file.string() + ".away");
    const Problems found = problems(stage());
    fs::rename(file.string() + ".away", file);
    return found;
  };
  const std::string missing = "is missing", no_identity = "cannot be checked without identity.pem",
                    no_ca = "cannot be checked without permissions_ca.pem";
  EXPECT_EQ(without(files_.identity_ca), (Problems{missing, "", "cannot be checked without identity_ca.pem",
                                                   no_identity, "", no_identity}));
  EXPECT_EQ(without(files_.permissions_ca), (Problems{"", missing, "", "", no_ca, no_ca}));
  EXPECT_EQ(without(files_.identity), (Problems{"", "", missing, no_identity, "", no_identity}));
  EXPECT_EQ(without(files_.private_key), (Problems{"", "", "", missing, "", ""}));
  EXPECT_EQ(without(files_.governance), (Problems{"", "", "", "", missing, ""}));
  EXPECT_EQ(without(files_.permissions), (Problems{"", "", "", "", "", missing}));
  fs::remove(recorder_.public_key);
  EXPECT_EQ(problems(signing()), (Problems{missing, "cannot be checked without signing_public.pem"}));
}

TEST_F(KeyVerdicts, AKeyFileHasOneByteToAMegabyte) {
  const auto of_size = [this](std::size_t size) {
    write_content(files_.identity, std::string(size, 'x'));
    return of_identity();
  };
  const std::string no_file = "is not a key file; " + kMakeNew,
                    no_certificate = "is not a certificate, or was altered; " + kMakeNew;
  EXPECT_EQ(of_size(0), no_file);
  EXPECT_EQ(of_size(1), no_certificate);
  EXPECT_EQ(of_size(1'048'576), no_certificate);
  EXPECT_EQ(of_size(1'048'577), no_file);
}

TEST_F(KeyVerdicts, SayTheModeOfWhatIsOpenToOthers) {
  const auto of_mode = [](const fs::path& file, mode_t mode) { ASSERT_EQ(chmod(file.c_str(), mode), 0); };
  of_mode(files_.identity, 0640);
  EXPECT_EQ(of_identity(), "is open to other users (mode 0640); chmod 600 " + files_.identity.string() +
                               "   (if another user may have copied it: make new keys)");
  of_mode(files_.identity, 0601);
  EXPECT_TRUE(of_identity().starts_with("is open to other users (mode 0601); "));
  of_mode(files_.identity, 0600);
  for (const mode_t open : {0710, 0720, 0740, 0701, 0702, 0704}) {
    of_mode(stage_folder(), open);
    of_mode(recorder_.private_key.parent_path(), open);
    const std::string said = fmt::format("folder: is open to other users (mode {:04o}); chmod 700 ", open);
    EXPECT_EQ(only(stage()), said + stage_folder().string());
    EXPECT_EQ(only(signing()), said + recorder_.private_key.parent_path().string());
  }
  of_mode(stage_folder(), 0700);
  for (const mode_t listed : {0710, 0740, 0701, 0704, 0755}) {  // others may see which roles there are
    of_mode(set_.folder(), listed);
    EXPECT_EQ(stage_problem(), "");
  }
  for (const mode_t open : {0720, 0702}) {
    of_mode(set_.folder(), open);
    EXPECT_EQ(only(stage()), fmt::format("folder: is open to other users (mode {:04o}); chmod 700 {}", open,
                                         set_.folder().string()));
  }
}

TEST_F(KeyVerdicts, SayWhatIsNoFolder) {
  const std::string make = "make keys: biopsy keys init";
  fs::remove_all(stage_folder());
  EXPECT_EQ(only(stage()), "folder: is missing; " + make);
  write_content(stage_folder(), "x");
  fs::permissions(stage_folder(), fs::perms::owner_all);
  EXPECT_EQ(only(stage()), "folder: is not a folder; " + make);
  EXPECT_EQ(stage()[0].file, stage_folder());
}

// What the owner may not read either. Root may read everything: its checks run as another user.
TEST_F(KeyVerdicts, SayWhyAFileOrFolderCannotBeRead) {
  struct AsUser {
    explicit AsUser(const fs::path& folder) {
      if (geteuid() != 0) return;
      constexpr uid_t kNobody = 65534;
      EXPECT_EQ(chown(folder.c_str(), kNobody, kNobody), 0);
      for (const auto& entry : fs::recursive_directory_iterator(folder))
        EXPECT_EQ(chown(entry.path().c_str(), kNobody, kNobody), 0);
      EXPECT_EQ(seteuid(kNobody), 0);
      was_root = true;
    }
    ~AsUser() { EXPECT_EQ(was_root ? seteuid(0) : 0, 0); }
    bool was_root = false;
  } const as_user(set_.folder().parent_path());
  const auto closed = [](const fs::path& path, const auto& said) {
    const fs::perms usual = fs::status(path).permissions();
    fs::permissions(path, fs::perms::none);
    const std::string found = said();
    fs::permissions(path, usual);
    return found;
  };
  const std::string denied = "cannot be read: Permission denied; ";
  ASSERT_EQ(stage_problem(), "");
  EXPECT_EQ(closed(files_.identity, [this] { return of_identity(); }),
            denied + "check who owns it, and start as that user");
  EXPECT_EQ(closed(stage_folder(), [this] { return of_identity(); }), denied + kMakeNew);
  EXPECT_EQ(closed(set_.folder().parent_path(), [this] { return only(stage()); }),
            "folder: " + denied + "make keys: biopsy keys init");
  EXPECT_EQ(stage_problem(), "");
}

TEST_F(KeyVerdicts, TimesAreThoseThatAreAskedForNotTheMachines) {
  const std::chrono::sys_seconds made{std::chrono::seconds(1'000'000'000)};
  const TestKeySet old(made, 10);
  const std::chrono::sys_seconds from = made - std::chrono::hours(1), until = made + std::chrono::days(10);
  const auto at = [&](std::chrono::sys_seconds time) {
    const FileVerdict verdict = inspect_keys(old.folder(), Role::Stage, time).at(2);
    return verdict.problem + "; " + verdict.remedy;
  };
  EXPECT_EQ(check_keys(old.folder(), Role::Stage, from), until);
  EXPECT_EQ(check_keys(old.folder(), Role::Stage, until), until);
  EXPECT_EQ(at(from - std::chrono::seconds(1)),
            "is not valid before 2001-09-09T00:46:40Z; check the clock of this machine");
  EXPECT_EQ(at(until + std::chrono::seconds(1)), "expired at 2001-09-19T01:46:40Z; " + kMakeNew);
}

TEST_F(KeyVerdicts, ACaIsOneByItsOwnWordAndItsOwnSignature) {
  const Certificate ca = read_certificate(file_content(files_.identity_ca));
  const Key other = new_p256_key();
  ASSERT_GT(X509_sign(ca.get(), other.get(), EVP_sha256()), 0);
  EXPECT_EQ(problem_with({{files_.identity_ca, pem(ca.get())}}),
            "identity_ca.pem: does not carry its own signature: it was altered");
  // A certificate of version 1 signs itself and does not say what it may be used for.
  const Certificate plain(X509_new());
  X509_NAME* name = X509_get_subject_name(plain.get());
  ASSERT_EQ(X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_ASC,
                                       reinterpret_cast<const unsigned char*>("plain"), -1, -1, 0),
            1);
  ASSERT_EQ(X509_set_issuer_name(plain.get(), name), 1);
  X509_gmtime_adj(X509_getm_notBefore(plain.get()), -3'600);
  X509_gmtime_adj(X509_getm_notAfter(plain.get()), 3'600);
  ASSERT_EQ(X509_set_pubkey(plain.get(), other.get()), 1);
  ASSERT_GT(X509_sign(plain.get(), other.get(), EVP_sha256()), 0);
  EXPECT_EQ(problem_with({{files_.identity_ca, pem(plain.get())}}),
            "identity_ca.pem: is not a CA certificate");
}

TEST_F(KeyVerdicts, ASigningKeyIsOfEd25519AndOfNoOtherKind) {
  const auto with = [this](EVP_PKEY* pair) {
    write_content(recorder_.public_key, public_pem(pair));
    write_content(recorder_.private_key, private_pem(pair));
    return problems(signing());
  };
  const Problems refused{"is not an Ed25519 public key, or was altered",
                         "cannot be checked without signing_public.pem"};
  EXPECT_EQ(with(new_ed25519_key().get()), (Problems{"", ""}));
  EXPECT_EQ(with(new_p256_key().get()), refused);
  EXPECT_EQ(with(Key(EVP_PKEY_Q_keygen(nullptr, nullptr, "ED448")).get()), refused);
  write_content(recorder_.public_key, "x");
  EXPECT_EQ(problems(signing()), refused);
}

// Or the bus would report them as its own.
TEST_F(KeyVerdicts, LeaveNoErrorOfOpenSslBehind) {
  write_content(files_.identity, "x");
  write_content(recorder_.public_key, "x");
  ERR_clear_error();
  (void)stage();
  EXPECT_EQ(ERR_peek_error(), 0U);
  (void)signing();
  EXPECT_EQ(ERR_peek_error(), 0U);
}

TEST_F(KeyVerdicts, TheFirstProblemIsThrownWithItsPlaceAndRemedy) {
  const auto thrown = [](const std::vector<FileVerdict>& verdicts) -> std::string {
    try {
      throw_first_problem(verdicts);
      return "";
    } catch (const ConfigError& error) {
      return error.where + ": " + error.what_is_wrong + "; " + error.remedy;
    }
  };
  const FileVerdict good{"/a", "A", {}, "", ""}, bad{"/b", "B", {}, "is bad", "correct it"},
      worse{"/c", "C", {}, "is worse", ""};
  EXPECT_EQ(thrown({}), "");
  EXPECT_EQ(thrown({good, good}), "");
  EXPECT_EQ(thrown({good, bad, worse}), "/b: is bad; correct it");
  EXPECT_EQ(thrown({worse, bad}), "/c: is worse; ");
}

TEST_F(KeyVerdicts, OfASetAreThoseOfItsRolesAndOfTheSigningKeysThatAreThere) {
  const std::array roles{Role::Stage, Role::Controller};
  EXPECT_EQ(problems(inspect_set(set_.folder(), roles, now())), Problems(16, ""));
  write_content(signing_files(set_.folder(), Signer::Commissioning).public_key, "x");
  const std::vector<FileVerdict> all = inspect_set(set_.folder(), roles, now());
  ASSERT_EQ(all.size(), 16U);
  EXPECT_EQ(all[14].problem, "is not an Ed25519 public key, or was altered");
  EXPECT_THROW(check_set(set_.folder(), roles, now()), ConfigError);
  fs::remove_all(set_.folder() / "commissioning");
  EXPECT_EQ(problems(inspect_set(set_.folder(), roles, now())), Problems(14, ""));
}

TEST_F(KeyVerdicts, EachCaIsComparedWithThatOfTheFirstRole) {
  const TestKeySet other;
  const RoleFiles controller = role_files(set_.folder(), Role::Controller),
                  theirs = role_files(other.folder(), Role::Controller);
  const std::array roles{Role::Stage, Role::Controller};
  const auto belongs = [&](const std::string& ca) {
    return "belongs to another set than stage/" + ca +
           "; copy the folders of all roles from one set, or make new keys: biopsy keys init --replace";
  };
  const auto said = [&](std::size_t file) {
    const FileVerdict verdict = inspect_set(set_.folder(), roles, now()).at(6 + file);
    return verdict.problem + "; " + verdict.remedy;
  };
  write_content(controller.identity_ca, file_content(theirs.identity_ca));
  EXPECT_EQ(said(0), belongs("identity_ca.pem"));
  EXPECT_EQ(said(1), "; ");
  write_content(controller.permissions_ca, file_content(theirs.permissions_ca));
  EXPECT_EQ(said(1), belongs("permissions_ca.pem"));
  write_content(controller.permissions_ca, "x");  // bad by itself: that is said
  EXPECT_EQ(said(1), "is not a certificate, or was altered; " + kMakeNew);
}

}  // namespace
}  // namespace biopsy::security
