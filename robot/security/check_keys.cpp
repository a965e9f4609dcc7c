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

// Why a file is bad, and the remedy. Never leaves this file.
struct Problem {
  std::string what, remedy;
};

void require(bool holds, std::string problem, std::string remedy = kMakeNew) {
  if (!holds) throw Problem{std::move(problem), std::move(remedy)};
}

std::string reason() {
  return std::generic_category().message(errno);
}

// Only the owner may read a file here, public ones too: together they decide who may write on the bus.
std::string private_content(const fs::path& path) {
  constexpr off_t kMostBytes = 1 << 20;
  struct stat facts {};
  const bool found = ::stat(path.c_str(), &facts) == 0;
  require(found, errno == ENOENT ? "is missing" : "cannot be read: " + reason());
  require(S_ISREG(facts.st_mode) && facts.st_size > 0 && facts.st_size <= kMostBytes, "is not a key file");
  require((facts.st_mode & 077U) == 0,
          fmt::format("is open to other users (mode {:04o})", facts.st_mode & 07777U),
          fmt::format("chmod 600 {}   (if another user may have copied it: make new keys)", path.string()));
  try {
    return read_file(path, "check who owns it, and start as that user");
  } catch (const ConfigError& unreadable) {
    throw Problem{unreadable.what_is_wrong, unreadable.remedy};
  }
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

// What `check` makes of a file, which throws Problem; empty where it does. Adds the verdict.
template <class Check>
auto checked(std::vector<FileVerdict>& verdicts, const fs::path& path, const char* subject, Check check) {
  FileVerdict& verdict = verdicts.emplace_back(
      FileVerdict{.file = path, .subject = subject, .until = {}, .problem = {}, .remedy = {}});
  try {
    return check(verdict);
  } catch (const Problem& problem) {
    verdict.problem = problem.what;
    verdict.remedy = problem.remedy;
    return decltype(check(verdict))();
  }
}

Certificate valid_certificate(FileVerdict& file, sys_seconds now) {
  Certificate certificate = read_certificate(private_content(file.file));
  const auto times = certificate ? validity(certificate.get()) : std::nullopt;
  require(times.has_value(), "is not a certificate, or was altered");
  file.subject = subject(certificate.get());
  file.until = times->until;
  require(now >= times->from, "is not valid before " + utc_text(times->from),
          "check the clock of this machine");
  require(now <= times->until, "expired at " + utc_text(times->until));
  return certificate;
}

Certificate valid_ca(FileVerdict& file, sys_seconds now) {
  Certificate ca = valid_certificate(file, now);
  require(X509_check_ca(ca.get()) == 1, "is not a CA certificate");
  require(is_signed_by(ca.get(), ca.get()), "does not carry its own signature: it was altered");
  return ca;
}

Certificate valid_identity(FileVerdict& file, Role role, X509* ca, sys_seconds now) {
  Certificate identity = valid_certificate(file, now);
  require(ca != nullptr, "cannot be checked without identity_ca.pem");
  require(is_signed_by(identity.get(), ca), "is not signed by identity_ca.pem, or was altered");
  require(file.subject == subject_of(role),
          fmt::format("is for \"{}\", not for \"{}\"", file.subject, subject_of(role)));
  return identity;
}

// `with`: the file that holds the public key.
void check_private_key(const FileVerdict& file, EVP_PKEY* public_key, const std::string& with) {
  const std::string content = private_content(file.file);
  require(public_key != nullptr, "cannot be checked without " + with);
  const Key key = read_private_key(content);
  require(key != nullptr, "is not a private key, or was altered");
  require(is_pair(key.get(), public_key), "does not belong to " + with + ", or was altered");
}

std::string signed_document(const FileVerdict& file, X509* ca) {
  const std::string content = private_content(file.file);
  require(ca != nullptr, "cannot be checked without permissions_ca.pem");
  const std::optional<std::string> text = verify_text(content, ca);
  require(text.has_value(), "is not signed by permissions_ca.pem, or was altered");
  return *text;
}

void check_permissions(FileVerdict& file, Role role, X509* identity, X509* ca) {
  const std::string text = signed_document(file, ca);
  require(identity != nullptr, "cannot be checked without identity.pem");
  const Validity times = *validity(identity);
  for (const Role other : kRoles)
    require(other == role || text != permissions_xml(other, times),
            fmt::format("is for the {}, not for the {}", name_of(other), name_of(role)));
  require(text == permissions_xml(role, times),
          fmt::format("differs from the permissions that this build grants the {}", name_of(role)));
  file.subject = fmt::format("permissions of {}", subject_of(role));
  file.until = times.until;
}

Key ed25519_public_key(const FileVerdict& file) {
  Key key = read_public_key(private_content(file.file));
  require(key && EVP_PKEY_get_id(key.get()) == EVP_PKEY_ED25519,
          "is not an Ed25519 public key, or was altered");
  return key;
}

}  // namespace

std::vector<FileVerdict> inspect_keys(const fs::path& folder, Role role, sys_seconds now) {
  const RoleFiles files = role_files(folder, role);
  if (const auto bad = folder_problem(folder, 022U)) return {*bad};
  if (const auto bad = folder_problem(files.identity.parent_path(), 077U)) return {*bad};
  std::vector<FileVerdict> verdicts;
  const auto ca = [now](FileVerdict& file) { return valid_ca(file, now); };
  const Certificate identity_ca = checked(verdicts, files.identity_ca, "certificate", ca);
  const Certificate permissions_ca = checked(verdicts, files.permissions_ca, "certificate", ca);
  const Certificate identity = checked(verdicts, files.identity, "certificate", [&](FileVerdict& file) {
    return valid_identity(file, role, identity_ca.get(), now);
  });
  checked(verdicts, files.private_key, "private key", [&](FileVerdict& file) {
    check_private_key(file, identity ? X509_get0_pubkey(identity.get()) : nullptr, "identity.pem");
  });
  checked(verdicts, files.governance, "governance", [&](FileVerdict& file) {
    require(signed_document(file, permissions_ca.get()) == governance_xml(),
            "differs from the governance of this build");
  });
  checked(verdicts, files.permissions, "permissions",
          [&](FileVerdict& file) { check_permissions(file, role, identity.get(), permissions_ca.get()); });
  ERR_clear_error();  // or the bus would report them as its own
  return verdicts;
}

std::vector<FileVerdict> inspect_signing_keys(const fs::path& folder, Signer signer) {
  const SigningFiles files = signing_files(folder, signer);
  if (const auto bad = folder_problem(files.private_key.parent_path(), 077U)) return {*bad};
  std::vector<FileVerdict> verdicts;
  const Key public_key = checked(verdicts, files.public_key, "public key", ed25519_public_key);
  checked(verdicts, files.private_key, "signing key",
          [&](FileVerdict& file) { check_private_key(file, public_key.get(), "signing_public.pem"); });
  ERR_clear_error();
  return verdicts;
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
