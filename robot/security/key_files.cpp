#include "robot/security/key_files.hpp"

#include <cstdlib>

#include "robot/common/config_error.hpp"

namespace biopsy::security {
namespace {

namespace fs = std::filesystem;

// The XDG specification: a relative path counts as not set.
fs::path from_environment(const char* name) {
  const char* value = std::getenv(name);
  const fs::path path = value == nullptr ? "" : value;
  return path.is_absolute() ? path : fs::path();
}

}  // namespace

RoleFiles role_files(const fs::path& folder, Role role) {
  const fs::path own = folder / name_of(role);
  return {.identity_ca = own / "identity_ca.pem",
          .permissions_ca = own / "permissions_ca.pem",
          .identity = own / "identity.pem",
          .private_key = own / "identity_key.pem",
          .governance = own / "governance.p7s",
          .permissions = own / "permissions.p7s"};
}

SigningFiles signing_files(const fs::path& folder, Signer signer) {
  const fs::path own = folder / (signer == Signer::Recorder ? "recorder" : "commissioning");
  return {.private_key = own / "signing_key.pem", .public_key = own / "signing_public.pem"};
}

fs::path ca_folder(const fs::path& folder) {
  return folder / "ca";
}

fs::path default_folder() {
  if (const fs::path config = from_environment("XDG_CONFIG_HOME"); !config.empty())
    return config / "biopsy" / "keys";
  const fs::path home = from_environment("HOME");
  if (home.empty())
    throw ConfigError("neither XDG_CONFIG_HOME nor HOME names a folder", "keys",
                      "name the folder of the keys on the command line");
  return home / ".config" / "biopsy" / "keys";
}

}  // namespace biopsy::security
