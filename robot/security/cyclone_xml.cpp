#include "robot/security/cyclone_xml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "robot/common/config_error.hpp"

namespace biopsy::security {
namespace {

namespace fs = std::filesystem;

// Debian installs the plugins in a folder that the loader does not search. Empty: the loader searches, as for
// an installation from source.
fs::path plugin_folder() {
#if defined(__aarch64__)
  const fs::path debian = "/usr/lib/aarch64-linux-gnu/libddsc0debian";
#else
  const fs::path debian = "/usr/lib/x86_64-linux-gnu/libddsc0debian";
#endif
  std::error_code ignored;
  return fs::is_directory(debian, ignored) ? debian : fs::path();
}

// A path with a slash is taken as it is; a bare name gets "lib" and ".so" from Cyclone DDS.
std::string plugin(const std::string& name) {
  const fs::path folder = plugin_folder();
  return folder.empty() ? name : (folder / ("lib" + name + ".so")).string();
}

// Cyclone DDS expands "${" in every value from the environment, drops " from paths and turns \ into /, and
// has no escape for them.
std::string escaped(const std::string& value) {
  const bool unusable = std::any_of(value.begin(), value.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 || c == '"' || c == '\\';
  });
  if (unusable || value.find("${") != std::string::npos)
    throw ConfigError("cannot stand in a configuration of Cyclone DDS", value,
                      "choose a name without ${, quotation marks, backslashes and control characters");
  constexpr std::array<std::pair<char, const char*>, 4> kEntities{
      {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'\'', "&apos;"}}};
  std::string text;
  for (const char c : value) {
    const auto entity = std::ranges::find(kEntities, c, &std::pair<char, const char*>::first);
    text += entity != kEntities.end() ? std::string(entity->second) : std::string(1, c);
  }
  return text;
}

// Loopback only, without multicast.
constexpr const char* kThisMachine =
    R"(<General><Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces>)"
    R"(<AllowMulticast>false</AllowMulticast><MaxMessageSize>65500B</MaxMessageSize></General>)";

// Multicast for discovery only; data is sent to its readers.
std::string on_network(const std::string& interface) {
  return fmt::format(
      R"(<General><Interfaces><NetworkInterface name="{}"/></Interfaces>)"
      R"(<AllowMulticast>spdp</AllowMulticast><MaxMessageSize>65500B</MaxMessageSize></General>)",
      escaped(interface));
}

// The default finds nine participants on one host.
std::string discovery(const CycloneOptions& options) {
  std::string text =
      "<Discovery><ParticipantIndex>auto</ParticipantIndex>"
      "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>";
  if (options.domain_on_wire)
    text += fmt::format("<ExternalDomainId>{}</ExternalDomainId>", *options.domain_on_wire);
  if (options.interface.empty()) text += R"(<Peers><Peer Address="127.0.0.1"/></Peers>)";
  return text + "</Discovery>";
}

// What is received is kept in buffers of this size, touched page by page in the first hours: small, so that a
// process is soon as large as it will be (1 MiB each by default). A chunk holds the longest message.
constexpr const char* kReceiveBuffers =
    "<Sizing><ReceiveBufferSize>256KiB</ReceiveBufferSize>"
    "<ReceiveBufferChunkSize>128KiB</ReceiveBufferChunkSize></Sizing>";

std::string library(const std::string& name, const std::string& subject) {
  return fmt::format(R"(<Library path="{}" initFunction="init_{}" finalizeFunction="finalize_{}"/>)",
                     escaped(plugin(name)), subject, subject);
}

std::string file(const char* element, const fs::path& path) {
  return fmt::format("<{0}>file:{1}</{0}>", element, escaped(fs::absolute(path).string()));
}

std::string security(const RoleFiles& files) {
  return "<Security><Authentication>" + library("dds_security_auth", "authentication") +
         file("IdentityCA", files.identity_ca) + file("IdentityCertificate", files.identity) +
         file("PrivateKey", files.private_key) + "</Authentication><AccessControl>" +
         library("dds_security_ac", "access_control") + file("PermissionsCA", files.permissions_ca) +
         file("Governance", files.governance) + file("Permissions", files.permissions) +
         "</AccessControl><Cryptographic>" + library("dds_security_crypto", "crypto") +
         "</Cryptographic></Security>";
}

}  // namespace

std::string cyclone_xml(const CycloneOptions& options) {
  return R"(<CycloneDDS xmlns="https://cdds.io/config"><Domain Id="any">)" +
         (options.interface.empty() ? kThisMachine : on_network(options.interface)) + discovery(options) +
         kReceiveBuffers +
         (options.enclave    ? security(*options.enclave)
          : options.security ? security(role_files(options.security->folder, options.security->role))
                             : "") +
         "</Domain></CycloneDDS>";
}

}  // namespace biopsy::security
