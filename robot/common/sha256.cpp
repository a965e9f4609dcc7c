#include "robot/common/sha256.hpp"

#include <openssl/evp.h>

#include <cstdio>
#include <cstdlib>

namespace biopsy {

Sha256 sha256(std::span<const std::byte> bytes) {
  Sha256 digest{};
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), nullptr, EVP_sha256(), nullptr) != 1) {
    std::fputs("SHA-256 is not available in this build of OpenSSL\n", stderr);
    std::abort();
  }
  return digest;
}

Sha256 sha256(std::string_view bytes) {
  return sha256(std::as_bytes(std::span(bytes)));
}

}  // namespace biopsy
