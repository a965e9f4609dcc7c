// Texts signed as S/MIME (multipart, clear text), the format of the documents of DDS Security 1.1.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "robot/security/openssl_handles.hpp"

namespace biopsy::security {

std::string sign_text(std::string_view text, X509* signer, EVP_PKEY* signer_key);

// The text, if this certificate signed it. At least as strict as the access control plugin of Cyclone DDS
// 0.10, which uses the same calls. The validity of the certificate is not checked.
std::optional<std::string> verify_text(std::string_view document, X509* signer);

}  // namespace biopsy::security
