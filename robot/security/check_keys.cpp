#include "robot/security/check_keys.hpp"

#include <fmt/format.h>
#include <openssl/err.h>
#include <openssl/x509v3.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/security/certificates.hpp"
#include "robot/security/signed_text.hpp"

namespace biopsy::security {
namespace {

namespace fs = std::filesystem;
using std::chrono::sys_seconds;

constexpr const char* kMakeNew = "make new keys: biopsy keys init --replace";

struct Inspected {
  FileVerdict verdict;
  std::string bytes;
  Certificate certificate;

  bool is_good() const { return verdict.problem.empty(); }
  // Only the first problem counts.
  void refuse_if(bool bad, std::string problem, std::string remedy = kMakeNew) {
    if (!bad || !is_good()) return;
    verdict.problem = std::move(problem);
    verdict.remedy = std::move(remedy);
  }
};

std::string reason() {
  return std::generic_category().message(errno);
}

// Nobody but the owner may read a file here; even a public one is part of what decides who may speak.
Inspected closed_file(const fs::path& path, std::string subject) {
  Inspected file{
      .verdict = {.file = path, .subject = std::move(subject), .until = {}, .problem = {}, .remedy = {}},
      .bytes = {},
      .certificate = {}};
  constexpr off_t kMostBytes = 1 << 20;
  struct stat facts {};
  if (::stat(path.c_str(), &facts) != 0) {
    file.refuse_if(true, errno == ENOENT ? "is missing" : "cannot be read: " + reason());
    return file;
  }
  file.refuse_if(!S_ISREG(facts.st_mode) || facts.st_size == 0 || facts.st_size > kMostBytes,
                 "is no file of keys");
  file.refuse_if(
      (facts.st_mode & 077U) != 0,
      fmt::format("is open to other users (mode {:04o})", facts.st_mode & 07777U),
      fmt::format("chmod 600 {}   (who read it may have copied it: then make new keys)", path.string()));
  if (!file.is_good()) return file;
  try {
    file.bytes = read_file(path, "check who owns it, and start as that user");
  } catch (const ConfigError& unreadable) {
    file.refuse_if(true, unreadable.what_is_wrong, unreadable.remedy);
  }
  return file;
}

// A folder that others may write could be filled by them with keys of their own.
std::optional<FileVerdict> trouble_with_folder(const fs::path& folder, unsigned forbidden) {
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

Inspected certificate_file(const fs::path& path, sys_seconds now) {
  Inspected file = closed_file(path, "certificate");
  if (!file.is_good()) return file;
  file.certificate = read_certificate(file.bytes);
  const auto times = file.certificate ? validity(file.certificate.get()) : std::nullopt;
  file.refuse_if(!times, "is no certificate, or was changed");
  if (!times) return file;
  file.verdict.subject = subject(file.certificate.get());
  file.verdict.until = times->until;
  file.refuse_if(now < times->from, "is not valid before " + utc_text(times->from),
                 "check the clock of this machine");
  file.refuse_if(now > times->until, "expired at " + utc_text(times->until));
  return file;
}

Inspected ca_file(const fs::path& path, sys_seconds now) {
  Inspected file = certificate_file(path, now);
  X509* ca = file.certificate.get();
  if (!file.is_good()) return file;
  file.refuse_if(X509_check_ca(ca) != 1, "is not the certificate of a CA");
  file.refuse_if(!is_signed_by(ca, ca), "does not carry its own signature: it was changed");
  return file;
}

Inspected identity_file(const fs::path& path, Role role, const Inspected& ca, sys_seconds now) {
  Inspected file = certificate_file(path, now);
  if (!file.is_good()) return file;
  file.refuse_if(!ca.is_good(), "cannot be judged without identity_ca.pem");
  if (!file.is_good()) return file;
  file.refuse_if(!is_signed_by(file.certificate.get(), ca.certificate.get()),
                 "is not signed by identity_ca.pem, or was changed");
  file.refuse_if(file.verdict.subject != subject_of(role),
                 fmt::format("is for \"{}\", not for \"{}\"", file.verdict.subject, subject_of(role)));
  return file;
}

Inspected key_file(const fs::path& path, const Inspected& identity) {
  Inspected file = closed_file(path, "private key");
  file.refuse_if(!identity.is_good(), "cannot be judged without identity.pem");
  if (!file.is_good()) return file;
  const Key key = read_private_key(file.bytes);
  file.refuse_if(!key, "is no private key, or was changed");
  if (!key) return file;
  file.refuse_if(!is_pair(key.get(), X509_get0_pubkey(identity.certificate.get())),
                 "does not belong to identity.pem, or was changed");
  return file;
}

// The text, where the signature holds.
std::string open_document(Inspected& file, const Inspected& ca) {
  file.refuse_if(!ca.is_good(), "cannot be judged without permissions_ca.pem");
  if (!file.is_good()) return {};
  const std::optional<std::string> text = opened_text(file.bytes, ca.certificate.get());
  file.refuse_if(!text, "is not signed by permissions_ca.pem, or was changed");
  return text.value_or("");
}

Inspected governance_file(const fs::path& path, const Inspected& ca) {
  Inspected file = closed_file(path, "governance");
  const std::string text = open_document(file, ca);
  file.refuse_if(text != governance_xml(), "does not protect exactly what this build protects");
  return file;
}

Inspected permissions_file(const fs::path& path, Role role, const Inspected& identity, const Inspected& ca) {
  Inspected file = closed_file(path, "permissions");
  const std::string text = open_document(file, ca);
  file.refuse_if(!identity.is_good(), "cannot be judged without identity.pem");
  if (!file.is_good()) return file;
  const Validity times = *validity(identity.certificate.get());
  for (const Role other : kRoles)
    file.refuse_if(other != role && text == permissions_xml(other, times),
                   fmt::format("is for the {}, not for the {}", name_of(other), name_of(role)));
  file.refuse_if(text != permissions_xml(role, times),
                 fmt::format("does not grant exactly what this build grants the {}", name_of(role)));
  file.verdict.subject = fmt::format("permissions of {}", subject_of(role));
  file.verdict.until = times.until;
  return file;
}

Inspected public_file(const fs::path& path, Key& key) {
  Inspected file = closed_file(path, "public key");
  if (!file.is_good()) return file;
  key = read_public_key(file.bytes);
  file.refuse_if(!key || EVP_PKEY_get_id(key.get()) != EVP_PKEY_ED25519,
                 "is no Ed25519 public key, or was changed");
  return file;
}

}  // namespace

std::vector<FileVerdict> inspect_keys(const fs::path& folder, Role role, sys_seconds now) {
  const RoleFiles files = role_files(folder, role);
  if (const auto bad = trouble_with_folder(folder, 022U)) return {*bad};
  if (const auto bad = trouble_with_folder(files.identity.parent_path(), 077U)) return {*bad};
  const Inspected identity_ca = ca_file(files.identity_ca, now);
  const Inspected permissions_ca = ca_file(files.permissions_ca, now);
  const Inspected identity = identity_file(files.identity, role, identity_ca, now);
  std::vector<FileVerdict> verdicts{
      identity_ca.verdict,
      permissions_ca.verdict,
      identity.verdict,
      key_file(files.private_key, identity).verdict,
      governance_file(files.governance, permissions_ca).verdict,
      permissions_file(files.permissions, role, identity, permissions_ca).verdict};
  ERR_clear_error();  // or the bus would report our refusals as its own
  return verdicts;
}

std::vector<FileVerdict> inspect_signing_keys(const fs::path& folder, Signer signer) {
  const SigningFiles files = signing_files(folder, signer);
  if (const auto bad = trouble_with_folder(files.private_key.parent_path(), 077U)) return {*bad};
  Key public_key;
  const Inspected shown = public_file(files.public_key, public_key);
  Inspected secret = closed_file(files.private_key, "signing key");
  secret.refuse_if(!shown.is_good(), "cannot be judged without signing_public.pem");
  if (secret.is_good()) {
    const Key key = read_private_key(secret.bytes);
    secret.refuse_if(!key, "is no private key, or was changed");
    secret.refuse_if(key && !is_pair(key.get(), public_key.get()),
                     "does not belong to signing_public.pem, or was changed");
  }
  ERR_clear_error();
  return {shown.verdict, secret.verdict};
}

void refuse_the_first_problem(const std::vector<FileVerdict>& verdicts) {
  for (const FileVerdict& verdict : verdicts)
    if (!verdict.problem.empty()) throw ConfigError(verdict.problem, verdict.file.string(), verdict.remedy);
}

sys_seconds check_keys(const fs::path& folder, Role role, sys_seconds now) {
  const std::vector<FileVerdict> verdicts = inspect_keys(folder, role, now);
  refuse_the_first_problem(verdicts);
  sys_seconds until = sys_seconds::max();
  for (const FileVerdict& verdict : verdicts) until = std::min(until, verdict.until.value_or(until));
  return until;
}

void check_signing_keys(const fs::path& folder, Signer signer) {
  refuse_the_first_problem(inspect_signing_keys(folder, signer));
}

}  // namespace biopsy::security
