#include "drivers/commissioning/signature.hpp"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"

namespace biopsy::commissioning {
namespace {

namespace fs = std::filesystem;

using Key = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;
using Context = std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)>;

constexpr std::size_t kSignature = 64;

const unsigned char* bytes_of(std::string_view text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}

// Fails only where OpenSSL was built without what every OpenSSL has.
void must(bool succeeded) {
  if (succeeded) return;
  std::fputs("Ed25519 is not available in this build of OpenSSL\n", stderr);
  std::abort();
}

// There is nobody to ask for a password: it would be asked for on the terminal of a process without one.
int no_password(char*, int, int, void*) {
  return -1;
}

constexpr const char* kRemedy = "make keys with `biopsy keys init`, or give the right file";

Key read_key(const fs::path& file, decltype(&PEM_read_bio_PrivateKey) read) {
  const std::string pem = read_file(file, kRemedy);
  BIO* const source = BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size()));
  Key key(read(source, nullptr, no_password, nullptr), EVP_PKEY_free);
  BIO_free(source);
  ERR_clear_error();
  if (!key || EVP_PKEY_get_id(key.get()) != EVP_PKEY_ED25519)
    throw ConfigError("is no Ed25519 key in PEM without a password", file.string(), kRemedy);
  return key;
}

}  // namespace

SigningKey::SigningKey(const fs::path& private_key)
    : key_(read_key(private_key, PEM_read_bio_PrivateKey).release()) {}

SigningKey::~SigningKey() {
  EVP_PKEY_free(static_cast<EVP_PKEY*>(key_));
}

std::string SigningKey::sign(std::string_view bytes) const {
  const Context context(EVP_MD_CTX_new(), EVP_MD_CTX_free);
  std::array<unsigned char, kSignature> signature{};
  std::size_t size = signature.size();
  must(EVP_DigestSignInit(context.get(), nullptr, nullptr, nullptr, static_cast<EVP_PKEY*>(key_)) == 1 &&
       EVP_DigestSign(context.get(), signature.data(), &size, bytes_of(bytes), bytes.size()) == 1);
  return {signature.begin(), signature.begin() + static_cast<std::ptrdiff_t>(size)};
}

bool is_signed(const fs::path& public_key, std::string_view bytes, std::string_view signature) {
  const Key key = read_key(public_key, PEM_read_bio_PUBKEY);
  const Context context(EVP_MD_CTX_new(), EVP_MD_CTX_free);
  must(EVP_DigestVerifyInit(context.get(), nullptr, nullptr, nullptr, key.get()) == 1);
  const bool right = EVP_DigestVerify(context.get(), bytes_of(signature), signature.size(), bytes_of(bytes),
                                      bytes.size()) == 1;
  ERR_clear_error();
  return right;
}

}  // namespace biopsy::commissioning
