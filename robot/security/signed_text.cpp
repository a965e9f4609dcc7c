#include "robot/security/signed_text.hpp"

#include <string>

namespace biopsy::security {
namespace {

using Store = std::unique_ptr<X509_STORE, Freed<X509_STORE_free>>;

void free_stack(STACK_OF(X509) * stack) {
  sk_X509_free(stack);
}

// A document may carry certificates: PKCS7_verify would accept one that the signer issued.
bool is_the_only_signer(PKCS7* document, X509* signer) {
  const std::unique_ptr<STACK_OF(X509), Freed<free_stack>> signers(PKCS7_get0_signers(document, nullptr, 0));
  return signers != nullptr && sk_X509_num(signers.get()) == 1 &&
         X509_cmp(sk_X509_value(signers.get(), 0), signer) == 0;
}

}  // namespace

std::string sign_text(std::string_view text, X509* signer, EVP_PKEY* signer_key) {
  constexpr int kFlags = PKCS7_TEXT | PKCS7_DETACHED;
  const Bio content = reader(text);
  const SignedDocument document(PKCS7_sign(signer, signer_key, nullptr, content.get(), kFlags));
  must(document != nullptr && BIO_reset(content.get()) == 1, "sign a document");
  const Bio out = writer();
  must(SMIME_write_PKCS7(out.get(), document.get(), content.get(), kFlags) == 1, "write a signed document");
  return written(out);
}

std::optional<std::string> verify_text(std::string_view document, X509* signer) {
  BIO* detached = nullptr;
  const SignedDocument parsed(SMIME_read_PKCS7(reader(document).get(), &detached));
  const Bio content(detached);
  if (parsed == nullptr || content == nullptr) return std::nullopt;
  const Store store(X509_STORE_new());
  must(store != nullptr && X509_STORE_add_cert(store.get(), signer) == 1, "trust a certificate");
  X509_STORE_set_flags(store.get(), X509_V_FLAG_NO_CHECK_TIME);
  const Bio out = writer();
  if (PKCS7_verify(parsed.get(), nullptr, store.get(), content.get(), out.get(), PKCS7_TEXT) != 1 ||
      !is_the_only_signer(parsed.get(), signer))
    return std::nullopt;
  std::string text = written(out);
  std::erase(text, '\r');  // S/MIME ends lines with CR LF
  return text;
}

}  // namespace biopsy::security
