#include "robot/security/make_keys.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <openssl/rand.h>

#include <array>

#include "robot/common/config_error.hpp"
#include "robot/common/files/atomic_directory.hpp"
#include "robot/security/certificates.hpp"
#include "robot/security/key_files.hpp"
#include "robot/security/key_set.hpp"
#include "robot/security/signed_text.hpp"

namespace biopsy::security {
namespace {

namespace fs = std::filesystem;

struct Authority {
  Key key;
  Certificate certificate;
};

Authority new_authority(const std::string& name, CaPurpose purpose, const Validity& validity) {
  Key key = new_p256_key();
  Certificate certificate = new_ca(name, key.get(), purpose, validity);
  return {std::move(key), std::move(certificate)};
}

// Distinguishes two sets by the names of their CAs.
std::string name_of_set() {
  std::uint32_t number = 0;
  must(RAND_bytes(reinterpret_cast<unsigned char*>(&number), sizeof number) == 1, "make random bytes");
  return fmt::format("{:08x}", number);
}

void write_role(AtomicDirectory& to, Role role, const Authority& identities, const Authority& permissions,
                const Validity& validity) {
  const RoleFiles files = role_files(to.path(), role);
  const Key key = new_p256_key();
  const Certificate identity =
      new_identity(role, key.get(), identities.certificate.get(), identities.key.get(), validity);
  const auto signed_by_ca = [&permissions](const std::string& text) {
    return sign_text(text, permissions.certificate.get(), permissions.key.get());
  };
  to.write(files.identity_ca, pem(identities.certificate.get()));
  to.write(files.permissions_ca, pem(permissions.certificate.get()));
  to.write(files.identity, pem(identity.get()));
  to.write(files.private_key, private_pem(key.get()));
  to.write(files.governance, signed_by_ca(governance_xml()));
  to.write(files.permissions, signed_by_ca(permissions_xml(role, validity)));
}

void write_set(AtomicDirectory& to, const Validity& validity) {
  const std::string set = name_of_set();
  const Authority identities = new_authority("identity CA " + set, CaPurpose::SignsIdentities, validity);
  const Authority permissions = new_authority("permissions CA " + set, CaPurpose::SignsDocuments, validity);
  for (const Role role : kRoles) write_role(to, role, identities, permissions, validity);
  for (const Signer signer : kSigners) {
    const SigningFiles files = signing_files(to.path(), signer);
    const Key key = new_ed25519_key();
    to.write(files.private_key, private_pem(key.get()));
    to.write(files.public_key, public_pem(key.get()));
  }
  to.write(ca_folder(to.path()) / "identity_ca_key.pem", private_pem(identities.key.get()));
  to.write(ca_folder(to.path()) / "permissions_ca_key.pem", private_pem(permissions.key.get()));
}

bool is_part_of_set(const fs::path& name) {
  for (const Role role : kRoles)
    if (name == name_of(role)) return true;
  return name == "ca" || name == "commissioning";
}

// Whether a set must be moved aside. Throws where that is not allowed.
bool is_occupied(const fs::path& folder, bool replace) {
  std::error_code trouble;
  if (!fs::exists(fs::symlink_status(folder, trouble))) return false;
  if (!fs::is_directory(folder, trouble))
    throw ConfigError("is not a folder", folder.string(), "name a folder for the keys");
  const fs::directory_iterator entries(folder, trouble);
  if (trouble) throw ConfigError("cannot be read", folder.string(), "check the rights of the folder");
  if (entries == fs::directory_iterator()) return false;
  for (const fs::directory_entry& entry : entries)
    if (!is_part_of_set(entry.path().filename()))
      throw ConfigError(
          "holds \"" + entry.path().filename().string() + "\", which is not part of a set of keys",
          folder.string(), "name an empty or new folder; nothing was touched");
  if (!replace)
    throw ConfigError("holds keys already", folder.string(),
                      "give --replace to make new ones; the old set is moved aside, nothing is lost");
  return true;
}

fs::path backup_path(const fs::path& folder, std::chrono::sys_seconds now) {
  const fs::path named = folder.has_filename() ? folder : folder.parent_path();
  const std::time_t time = std::chrono::system_clock::to_time_t(now);
  fs::path aside = fmt::format("{}.{:%Y%m%dT%H%M%SZ}", named.string(), fmt::gmtime(time));
  if (fs::exists(fs::symlink_status(aside)))
    throw ConfigError("is there already, and the old keys should go there", aside.string(),
                      "wait a second, or move it away; nothing was touched");
  return aside;
}

}  // namespace

MadeKeys make_keys(const fs::path& folder, int days, std::chrono::sys_seconds now, bool replace) {
  if (days < kLeastDays || days > kMostDays)
    throw ConfigError(fmt::format("keys cannot be valid for {} days", days), "--days",
                      fmt::format("give {} to {} days", kLeastDays, kMostDays));
  MadeKeys made{.validity = {now - std::chrono::hours(1), now + std::chrono::days(days)}, .old_set = {}};
  if (is_occupied(folder, replace)) made.old_set = backup_path(folder, now);
  AtomicDirectory fresh(folder);
  write_set(fresh, made.validity);
  check_set(fresh.path(), kRoles, now);
  fresh.settle(made.old_set);
  return made;
}

}  // namespace biopsy::security
