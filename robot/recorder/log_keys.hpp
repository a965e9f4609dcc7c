// The Ed25519 keys of a log: the private one signs its head, the public one shows that it did. Read from PEM
// files (PKCS #8 and SubjectPublicKeyInfo). Throws ConfigError for a file that holds no such key.
#pragma once

#include <openssl/types.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace biopsy::recorder {

using PublicKey = std::array<std::uint8_t, 32>;
using Signature = std::array<std::uint8_t, 64>;

PublicKey read_public_key(const std::filesystem::path& pem);
std::string pem_of(const PublicKey& key);
bool is_signed_by(const PublicKey& key, const Signature& signature, std::string_view bytes);

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

}  // namespace biopsy::recorder
