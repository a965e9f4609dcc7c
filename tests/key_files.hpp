// Ed25519 keys for tests, made by OpenSSL; other kinds to be refused.
#pragma once

#include <openssl/evp.h>
#include <openssl/pem.h>

#include <cstdio>
#include <filesystem>

namespace biopsy {

// `public_pem`: empty for none.
inline void make_key_files(const std::filesystem::path& private_pem,
                           const std::filesystem::path& public_pem = {}, const char* kind = "ED25519") {
  EVP_PKEY* const key = EVP_PKEY_Q_keygen(nullptr, nullptr, kind);
  std::FILE* file = std::fopen(private_pem.c_str(), "w");
  PEM_write_PrivateKey(file, key, nullptr, nullptr, 0, nullptr, nullptr);
  std::fclose(file);
  if (!public_pem.empty()) {
    file = std::fopen(public_pem.c_str(), "w");
    PEM_write_PUBKEY(file, key);
    std::fclose(file);
  }
  EVP_PKEY_free(key);
}

}  // namespace biopsy
