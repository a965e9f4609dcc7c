#include "robot/common/sha256.hpp"

#include <openssl/evp.h>

#include "robot/common/logging/logger.hpp"

namespace biopsy {

Sha256 sha256(std::span<const std::byte> bytes) {
  Sha256 digest{};
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), nullptr, EVP_sha256(), nullptr) != 1)
    logging::fatal(logging::Component::Security, "this build of OpenSSL has no SHA-256");
  return digest;
}

Sha256 sha256(std::string_view bytes) {
  return sha256(std::as_bytes(std::span(bytes)));
}

}  // namespace biopsy
