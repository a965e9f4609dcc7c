#include "robot/common/ed25519.hpp"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/logging/logger.hpp"

namespace biopsy {
namespace {

namespace fs = std::filesystem;

using Key = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;
using Bio = std::unique_ptr<BIO, decltype(&BIO_free)>;
using Context = std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)>;

const unsigned char* bytes_of(std::string_view text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}

void require(bool done) {
  if (!done) logging::fatal(logging::Component::Security, "this build of OpenSSL has no Ed25519");
}

// A key with a password is refused: no process of the robot has an operator who could type it.
int no_password(char*, int, int, void*) {
  return -1;
}

Key read_key(const fs::path& file, decltype(&PEM_read_bio_PrivateKey) read, const std::string& remedy) {
  const std::string pem = read_file(file, remedy);
  const Bio bio(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())), BIO_free);
  Key key(read(bio.get(), nullptr, no_password, nullptr), EVP_PKEY_free);
  ERR_clear_error();
  if (!key || EVP_PKEY_get_id(key.get()) != EVP_PKEY_ED25519)
    throw ConfigError("is no Ed25519 key in PEM without a password", file.string(), remedy);
  return key;
}

PublicKey public_key_of(const EVP_PKEY* key) {
  PublicKey raw{};
  std::size_t size = raw.size();
  require(EVP_PKEY_get_raw_public_key(key, raw.data(), &size) == 1 && size == raw.size());
  return raw;
}

Key key_of(const PublicKey& raw) {
  return {EVP_PKEY_new_raw_public_key(EVP_PKEY_ED25519, nullptr, raw.data(), raw.size()), EVP_PKEY_free};
}

}  // namespace

PublicKey read_public_key(const fs::path& pem, const std::string& remedy) {
  return public_key_of(read_key(pem, PEM_read_bio_PUBKEY, remedy).get());
}

std::string pem_of(const PublicKey& key) {
  const Bio bio(BIO_new(BIO_s_mem()), BIO_free);
  require(bio && PEM_write_bio_PUBKEY(bio.get(), key_of(key).get()) == 1);
  char* text = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &text);
  return {text, static_cast<std::size_t>(size)};
}

bool is_signed_by(const PublicKey& key, std::string_view signature, std::string_view bytes) {
  const Key known = key_of(key);
  const Context context(EVP_MD_CTX_new(), EVP_MD_CTX_free);
  require(known && context &&
          EVP_DigestVerifyInit(context.get(), nullptr, nullptr, nullptr, known.get()) == 1);
  const bool holds = EVP_DigestVerify(context.get(), bytes_of(signature), signature.size(), bytes_of(bytes),
                                      bytes.size()) == 1;
  ERR_clear_error();
  return holds;
}

SigningKey::SigningKey(const fs::path& pem)
    : key_(read_key(pem, PEM_read_bio_PrivateKey, kKeyRemedy).release()) {}

void SigningKey::Free::operator()(EVP_PKEY* key) const {
  EVP_PKEY_free(key);
}

PublicKey SigningKey::public_key() const {
  return public_key_of(key_.get());
}

Signature SigningKey::sign(std::string_view bytes) const {
  const Context context(EVP_MD_CTX_new(), EVP_MD_CTX_free);
  Signature signature{};
  std::size_t size = signature.size();
  require(context && EVP_DigestSignInit(context.get(), nullptr, nullptr, nullptr, key_.get()) == 1 &&
          EVP_DigestSign(context.get(), signature.data(), &size, bytes_of(bytes), bytes.size()) == 1 &&
          size == signature.size());
  return signature;
}

}  // namespace biopsy
