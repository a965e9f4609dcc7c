// Ed25519 signatures over whole texts. Keys are PEM files without a password.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace biopsy::commissioning {

class SigningKey {
 public:
  explicit SigningKey(const std::filesystem::path& private_key);  // throws ConfigError
  ~SigningKey();
  SigningKey(const SigningKey&) = delete;
  SigningKey& operator=(const SigningKey&) = delete;

  std::string sign(std::string_view bytes) const;  // 64 bytes, as `openssl pkeyutl -verify -rawin` takes them

 private:
  void* key_;  // EVP_PKEY
};

// Throws ConfigError where `public_key` is none; a wrong signature, of whatever size, is false.
bool is_signed(const std::filesystem::path& public_key, std::string_view bytes, std::string_view signature);

}  // namespace biopsy::commissioning
