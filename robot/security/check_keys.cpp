#include "robot/security/check_keys.hpp"

#include <fmt/format.h>
#include <openssl/err.h>
#include <openssl/x509v3.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <system_error>

#include "robot/common/config_error.hpp"
#include "robot/security/certificates.hpp"
#include "robot/security/signed_text.hpp"

namespace biopsy::security {
namespace {

namespace fs = std::filesystem;
using std::chrono::sys_seconds;

constexpr const char* kMakeNew = "make new keys: biopsy keys init --replace";

struct CheckedFile {
  FileVerdict verdict;
  std::string bytes;
  Certificate certificate;

  bool ok() const { return verdict.problem.empty(); }
  // Keeps the first problem.
  void fail_if(bool bad, std::string problem, std::string remedy = kMakeNew) {
    if (!bad || !ok()) return;
    verdict.problem = std::move(problem);
    verdict.remedy = std::move(remedy);
  }
};

std::string reason() {
  return std::generic_category().message(errno);
}

// Only the owner may read a file here, public ones too: together they decide who may write on the bus.
CheckedFile private_file(const fs::path& path, std::string subject) {
  CheckedFile file{
      .verdict = {.file = path, .subject = std::move(subject), .until = {}, .problem = {}, .remedy = {}},
      .bytes = {},
      .certificate = {}};
  constexpr off_t kMostBytes = 1 << 20;
  struct stat facts {};
  if (::stat(path.c_str(), &facts) != 0) {
    file.fail_if(true, errno == ENOENT ? "is missing" : "cannot be read: " + reason());
    return file;
  }
  file.fail_if(!S_ISREG(facts.st_mode) || facts.st_size == 0 || facts.st_size > kMostBytes,
               "is not a key file");
  file.fail_if(
      (facts.st_mode & 077U) != 0,
      fmt::format("is open to other users (mode {:04o})", facts.st_mode & 07777U),
      fmt::format("chmod 600 {}   (if another user may have copied it: make new keys)", path.string()));
  if (!file.ok()) return file;
  std::ifstream stream(path, std::ios::binary);
  file.bytes.assign(std::istreambuf_iterator<char>(stream), {});
  file.fail_if(!stream.is_open() || stream.bad() || file.bytes.empty(), "cannot be read: " + reason(),
               "check who owns it, and start as that user");
  return file;
}

// In a folder that others may write they can place keys of their own.
std::optional<FileVerdict> folder_problem(const fs::path& folder, unsigned forbidden) {
  struct stat facts {};
  FileVerdict bad{.file = folder, .subject = "folder", .until = {}, .problem = {}, .remedy = {}};
  if (::stat(folder.c_str(), &facts) != 0)
    bad.problem = errno == ENOENT ? "is missing" : "cannot be read: " + reason();
  else if (!S_ISDIR(facts.st_mode))
    bad.problem = "is not a folder";
  else if ((facts.st_mode & forbidden) != 0)
    bad.problem = fmt::format("is open to other users (mode {:04o})", facts.st_mode & 07777U);
  else
    return std::nullopt;
  bad.remedy = S_ISDIR(facts.st_mode) ? "chmod 700 " + folder.string() : "make keys: biopsy keys init";
  return bad;
}

CheckedFile certificate_file(const fs::path& path, sys_seconds now) {
  CheckedFile file = private_file(path, "certificate");
  if (!file.ok()) return file;
  file.certificate = read_certificate(file.bytes);
  const auto times = file.certificate ? validity(file.certificate.get()) : std::nullopt;
  file.fail_if(!times, "is not a certificate, or was altered");
  if (!times) return file;
  file.verdict.subject = subject(file.certificate.get());
  file.verdict.until = times->until;
  file.fail_if(now < times->from, "is not valid before " + utc_text(times->from),
               "check the clock of this machine");
  file.fail_if(now > times->until, "expired at " + utc_text(times->until));
  return file;
}

CheckedFile ca_file(const fs::path& path, sys_seconds now) {
  CheckedFile file = certificate_file(path, now);
  X509* ca = file.certificate.get();
  if (!file.ok()) return file;
  file.fail_if(X509_check_ca(ca) != 1, "is not a CA certificate");
  file.fail_if(!is_signed_by(ca, ca), "does not carry its own signature: it was altered");
  return file;
}

CheckedFile identity_file(const fs::path& path, Role role, const CheckedFile& ca, sys_seconds now) {
  CheckedFile file = certificate_file(path, now);
  if (!file.ok()) return file;
  file.fail_if(!ca.ok(), "cannot be checked without identity_ca.pem");
  if (!file.ok()) return file;
  file.fail_if(!is_signed_by(file.certificate.get(), ca.certificate.get()),
               "is not signed by identity_ca.pem, or was altered");
  file.fail_if(file.verdict.subject != subject_of(role),
               fmt::format("is for \"{}\", not for \"{}\"", file.verdict.subject, subject_of(role)));
  return file;
}

CheckedFile key_file(const fs::path& path, const CheckedFile& identity) {
  CheckedFile file = private_file(path, "private key");
  file.fail_if(!identity.ok(), "cannot be checked without identity.pem");
  if (!file.ok()) return file;
  const Key key = read_private_key(file.bytes);
  file.fail_if(!key, "is not a private key, or was altered");
  if (!key) return file;
  file.fail_if(!is_pair(key.get(), X509_get0_pubkey(identity.certificate.get())),
               "does not belong to identity.pem, or was altered");
  return file;
}

// The text of a document whose signature is valid.
std::string verified_document(CheckedFile& file, const CheckedFile& ca) {
  file.fail_if(!ca.ok(), "cannot be checked without permissions_ca.pem");
  if (!file.ok()) return {};
  const std::optional<std::string> text = verify_text(file.bytes, ca.certificate.get());
  file.fail_if(!text, "is not signed by permissions_ca.pem, or was altered");
  return text.value_or("");
}

CheckedFile governance_file(const fs::path& path, const CheckedFile& ca) {
  CheckedFile file = private_file(path, "governance");
  const std::string text = verified_document(file, ca);
  file.fail_if(text != governance_xml(), "differs from the governance of this build");
  return file;
}

CheckedFile permissions_file(const fs::path& path, Role role, const CheckedFile& identity,
                             const CheckedFile& ca) {
  CheckedFile file = private_file(path, "permissions");
  const std::string text = verified_document(file, ca);
  file.fail_if(!identity.ok(), "cannot be checked without identity.pem");
  if (!file.ok()) return file;
  const Validity times = *validity(identity.certificate.get());
  for (const Role other : kRoles)
    file.fail_if(other != role && text == permissions_xml(other, times),
                 fmt::format("is for the {}, not for the {}", name_of(other), name_of(role)));
  file.fail_if(text != permissions_xml(role, times),
               fmt::format("differs from the permissions that this build grants the {}", name_of(role)));
  file.verdict.subject = fmt::format("permissions of {}", subject_of(role));
  file.verdict.until = times.until;
  return file;
}

CheckedFile public_file(const fs::path& path, Key& key) {
  CheckedFile file = private_file(path, "public key");
  if (!file.ok()) return file;
  key = read_public_key(file.bytes);
  file.fail_if(!key || EVP_PKEY_get_id(key.get()) != EVP_PKEY_ED25519,
               "is not an Ed25519 public key, or was altered");
  return file;
}

}  // namespace

std::vector<FileVerdict> inspect_keys(const fs::path& folder, Role role, sys_seconds now) {
  const RoleFiles files = role_files(folder, role);
  if (const auto bad = folder_problem(folder, 022U)) return {*bad};
  if (const auto bad = folder_problem(files.identity.parent_path(), 077U)) return {*bad};
  const CheckedFile identity_ca = ca_file(files.identity_ca, now);
  const CheckedFile permissions_ca = ca_file(files.permissions_ca, now);
  const CheckedFile identity = identity_file(files.identity, role, identity_ca, now);
  std::vector<FileVerdict> verdicts{
      identity_ca.verdict,
      permissions_ca.verdict,
      identity.verdict,
      key_file(files.private_key, identity).verdict,
      governance_file(files.governance, permissions_ca).verdict,
      permissions_file(files.permissions, role, identity, permissions_ca).verdict};
  ERR_clear_error();  // or the bus would report them as its own
  return verdicts;
}

std::vector<FileVerdict> inspect_signing_keys(const fs::path& folder, Signer signer) {
  const SigningFiles files = signing_files(folder, signer);
  if (const auto bad = folder_problem(files.private_key.parent_path(), 077U)) return {*bad};
  Key public_key;
  const CheckedFile shown = public_file(files.public_key, public_key);
  CheckedFile secret = private_file(files.private_key, "signing key");
  secret.fail_if(!shown.ok(), "cannot be checked without signing_public.pem");
  if (secret.ok()) {
    const Key key = read_private_key(secret.bytes);
    secret.fail_if(!key, "is not a private key, or was altered");
    secret.fail_if(key && !is_pair(key.get(), public_key.get()),
                   "does not belong to signing_public.pem, or was altered");
  }
  ERR_clear_error();
  return {shown.verdict, secret.verdict};
}

void throw_first_problem(const std::vector<FileVerdict>& verdicts) {
  for (const FileVerdict& verdict : verdicts)
    if (!verdict.problem.empty()) throw ConfigError(verdict.problem, verdict.file.string(), verdict.remedy);
}

sys_seconds check_keys(const fs::path& folder, Role role, sys_seconds now) {
  const std::vector<FileVerdict> verdicts = inspect_keys(folder, role, now);
  throw_first_problem(verdicts);
  sys_seconds until = sys_seconds::max();
  for (const FileVerdict& verdict : verdicts) until = std::min(until, verdict.until.value_or(until));
  return until;
}

void check_signing_keys(const fs::path& folder, Signer signer) {
  throw_first_problem(inspect_signing_keys(folder, signer));
}

}  // namespace biopsy::security
