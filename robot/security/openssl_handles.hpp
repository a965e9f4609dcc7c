// Owners of what OpenSSL allocates.
#pragma once

#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>

#include <memory>
#include <string>
#include <string_view>

namespace biopsy::security {

template <auto Free>
struct Freed {
  template <class T>
  void operator()(T* it) const {
    Free(it);
  }
};
inline void free_bio(BIO* bio) {
  BIO_free_all(bio);
}

using Bio = std::unique_ptr<BIO, Freed<free_bio>>;
using Key = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, Freed<X509_free>>;
using SignedDocument = std::unique_ptr<PKCS7, Freed<PKCS7_free>>;

// For reading: the bytes must outlive it.
Bio reader(std::string_view bytes);
Bio writer();
std::string written(const Bio& bio);

// For calls that fail only without memory or with a broken OpenSSL: ends the program with OpenSSL's reason.
void must(bool succeeded, const char* doing);

}  // namespace biopsy::security
