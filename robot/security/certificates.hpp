// Key pairs and X.509 certificates, as PEM.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "robot/security/grants.hpp"
#include "robot/security/openssl_handles.hpp"

namespace biopsy::security {

Key new_p256_key();
Key new_ed25519_key();

enum class CaPurpose { SignsIdentities, SignsDocuments };
Certificate new_ca(std::string_view name, EVP_PKEY* key, CaPurpose purpose, const Validity& validity);
Certificate new_identity(Role role, EVP_PKEY* key, X509* ca, EVP_PKEY* ca_key, const Validity& validity);

std::string private_pem(EVP_PKEY* key);
std::string public_pem(EVP_PKEY* key);
std::string pem(X509* certificate);

// Null where the text holds none. A key with a pass phrase counts as none: there is no prompt.
Key read_private_key(std::string_view pem);
Key read_public_key(std::string_view pem);
Certificate read_certificate(std::string_view pem);

// The subject as RFC 2253 writes it.
std::string subject(X509* certificate);
std::optional<Validity> validity(X509* certificate);
bool is_signed_by(X509* certificate, X509* ca);
// Checked by signing and verifying: a private key file may carry a public key of another pair.
bool is_pair(EVP_PKEY* private_key, EVP_PKEY* public_key);

}  // namespace biopsy::security
