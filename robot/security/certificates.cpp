#include "robot/security/certificates.hpp"

#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>

#include <array>
#include <ctime>

namespace biopsy::security {
namespace {

void set_times(X509* certificate, const Validity& validity) {
  std::time_t from = std::chrono::system_clock::to_time_t(validity.from);
  std::time_t until = std::chrono::system_clock::to_time_t(validity.until);
  must(X509_time_adj_ex(X509_getm_notBefore(certificate), 0, 0, &from) != nullptr &&
           X509_time_adj_ex(X509_getm_notAfter(certificate), 0, 0, &until) != nullptr,
       "set the times of a certificate");
}

void set_random_serial(X509* certificate) {
  std::array<unsigned char, 16> bytes{};
  must(RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) == 1, "make random bytes");
  bytes[0] = (bytes[0] & 0x3fU) | 0x40U;  // positive, of constant length
  const std::unique_ptr<BIGNUM, Freed<BN_free>> number(
      BN_bin2bn(bytes.data(), static_cast<int>(bytes.size()), nullptr));
  must(number != nullptr && BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(certificate)) != nullptr,
       "number a certificate");
}

void add_name(X509_NAME* name, const char* field, std::string_view value) {
  must(X509_NAME_add_entry_by_txt(name, field, MBSTRING_UTF8,
                                  reinterpret_cast<const unsigned char*>(value.data()),
                                  static_cast<int>(value.size()), -1, 0) == 1,
       "name a certificate");
}

void add_extension(X509* certificate, X509* issuer, int kind, const char* value) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
  const std::unique_ptr<X509_EXTENSION, Freed<X509_EXTENSION_free>> extension(
      X509V3_EXT_conf_nid(nullptr, &context, kind, value));
  must(extension != nullptr && X509_add_ext(certificate, extension.get(), -1) == 1, "extend a certificate");
}

// Everything but issuer, extensions and signature.
Certificate blank(std::string_view name, EVP_PKEY* key, const Validity& validity) {
  Certificate made(X509_new());
  must(made != nullptr && X509_set_version(made.get(), X509_VERSION_3) == 1, "make a certificate");
  set_random_serial(made.get());
  set_times(made.get(), validity);
  X509_NAME* subject = X509_get_subject_name(made.get());
  add_name(subject, "O", "biopsy");
  add_name(subject, "CN", name);
  must(X509_set_pubkey(made.get(), key) == 1, "put a key into a certificate");
  return made;
}

void issue(X509* certificate, X509* issuer, EVP_PKEY* issuer_key) {
  must(X509_set_issuer_name(certificate, X509_get_subject_name(issuer)) == 1, "name an issuer");
  add_extension(certificate, issuer, NID_subject_key_identifier, "hash");
  add_extension(certificate, issuer, NID_authority_key_identifier, "keyid");
  must(X509_sign(certificate, issuer_key, EVP_sha256()) > 0, "sign a certificate");
}

// Callback in place of OpenSSL's prompt on the terminal.
int no_pass_phrase(char*, int, int, void*) {
  return -1;
}

std::optional<std::chrono::sys_seconds> seconds(const ASN1_TIME* time) {
  std::tm parts{};
  if (time == nullptr || ASN1_TIME_to_tm(time, &parts) != 1) return std::nullopt;
  return std::chrono::time_point_cast<std::chrono::seconds>(
      std::chrono::system_clock::from_time_t(timegm(&parts)));
}

}  // namespace

Key new_p256_key() {
  Key key(EVP_EC_gen("P-256"));
  must(key != nullptr, "make a key");
  return key;
}

Key new_ed25519_key() {
  Key key(EVP_PKEY_Q_keygen(nullptr, nullptr, "ED25519"));
  must(key != nullptr, "make a key");
  return key;
}

Certificate new_ca(std::string_view name, EVP_PKEY* key, CaPurpose purpose, const Validity& validity) {
  Certificate ca = blank(name, key, validity);
  add_extension(ca.get(), ca.get(), NID_basic_constraints, "critical,CA:TRUE,pathlen:0");
  add_extension(ca.get(), ca.get(), NID_key_usage,
                purpose == CaPurpose::SignsIdentities ? "critical,keyCertSign,cRLSign"
                                                      : "critical,digitalSignature,keyCertSign");
  issue(ca.get(), ca.get(), key);
  return ca;
}

Certificate new_identity(Role role, EVP_PKEY* key, X509* ca, EVP_PKEY* ca_key, const Validity& validity) {
  Certificate identity = blank(name_of(role), key, validity);
  add_extension(identity.get(), ca, NID_basic_constraints, "critical,CA:FALSE");
  add_extension(identity.get(), ca, NID_key_usage, "critical,digitalSignature");
  issue(identity.get(), ca, ca_key);
  return identity;
}

std::string private_pem(EVP_PKEY* key) {
  const Bio out = writer();
  must(PEM_write_bio_PKCS8PrivateKey(out.get(), key, nullptr, nullptr, 0, nullptr, nullptr) == 1,
       "write a private key");
  return written(out);
}

std::string public_pem(EVP_PKEY* key) {
  const Bio out = writer();
  must(PEM_write_bio_PUBKEY(out.get(), key) == 1, "write a public key");
  return written(out);
}

std::string pem(X509* certificate) {
  const Bio out = writer();
  must(PEM_write_bio_X509(out.get(), certificate) == 1, "write a certificate");
  return written(out);
}

Key read_private_key(std::string_view pem) {
  return Key(PEM_read_bio_PrivateKey(reader(pem).get(), nullptr, no_pass_phrase, nullptr));
}

Key read_public_key(std::string_view pem) {
  return Key(PEM_read_bio_PUBKEY(reader(pem).get(), nullptr, no_pass_phrase, nullptr));
}

Certificate read_certificate(std::string_view pem) {
  return Certificate(PEM_read_bio_X509(reader(pem).get(), nullptr, no_pass_phrase, nullptr));
}

std::string subject(X509* certificate) {
  const Bio out = writer();
  X509_NAME_print_ex(out.get(), X509_get_subject_name(certificate), 0, XN_FLAG_RFC2253);
  return written(out);
}

std::optional<Validity> validity(X509* certificate) {
  const auto from = seconds(X509_get0_notBefore(certificate));
  const auto until = seconds(X509_get0_notAfter(certificate));
  if (!from || !until) return std::nullopt;
  return Validity{*from, *until};
}

bool is_signed_by(X509* certificate, X509* ca) {
  return X509_check_issued(ca, certificate) == X509_V_OK &&
         X509_verify(certificate, X509_get0_pubkey(ca)) == 1;
}

bool is_pair(EVP_PKEY* private_key, EVP_PKEY* public_key) {
  const std::array<unsigned char, 16> message{};
  std::array<unsigned char, 512> signature{};
  std::size_t size = signature.size();
  const std::unique_ptr<EVP_MD_CTX, Freed<EVP_MD_CTX_free>> signing(EVP_MD_CTX_new()),
      verifying(EVP_MD_CTX_new());
  must(signing != nullptr && verifying != nullptr, "hold a signature");
  const EVP_MD* digest = EVP_PKEY_get_id(private_key) == EVP_PKEY_ED25519 ? nullptr : EVP_sha256();
  return EVP_DigestSignInit(signing.get(), nullptr, digest, nullptr, private_key) == 1 &&
         EVP_DigestSign(signing.get(), signature.data(), &size, message.data(), message.size()) == 1 &&
         EVP_DigestVerifyInit(verifying.get(), nullptr, digest, nullptr, public_key) == 1 &&
         EVP_DigestVerify(verifying.get(), signature.data(), size, message.data(), message.size()) == 1;
}

}  // namespace biopsy::security
