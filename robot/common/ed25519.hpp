// Ed25519 signatures (RFC 8032), by OpenSSL. Keys are PEM files without a password: PKCS #8 for private,
// SubjectPublicKeyInfo for public ones. Throws ConfigError, with `remedy`, for a file that holds no such key.
#pragma once

#include <openssl/types.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace biopsy {

inline constexpr const char* kKeyRemedy = "make keys with `biopsy keys init`, or name the right file";

using PublicKey = std::array<std::uint8_t, 32>;
using Signature = std::array<std::uint8_t, 64>;

PublicKey read_public_key(const std::filesystem::path& pem, const std::string& remedy = kKeyRemedy);
std::string pem_of(const PublicKey& key);
// A signature of another size than 64 bytes is none.
bool is_signed_by(const PublicKey& key, std::string_view signature, std::string_view bytes);

class SigningKey {
 public:
  explicit SigningKey(const std::filesystem::path& pem);

  PublicKey public_key() const;
  Signature sign(std::string_view bytes) const;

 private:
  struct Free {
    void operator()(EVP_PKEY* key) const;
  };
  std::unique_ptr<EVP_PKEY, Free> key_;
};

// As is_signed_by takes it, and a signature file holds it.
inline std::string_view view(const Signature& signature) {
  return {reinterpret_cast<const char*>(signature.data()), signature.size()};
}

}  // namespace biopsy
