// Texts signed as S/MIME (multipart, clear text), as DDS Security wants its documents.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "robot/security/openssl_handles.hpp"

namespace biopsy::security {

std::string signed_text(std::string_view text, X509* signer, EVP_PKEY* signer_key);

// The text, where this very certificate signed it; nothing otherwise. At least as strict as the access
// control plugin of Cyclone DDS 0.10, which reads with the same calls. The time of the certificate is not
// looked at.
std::optional<std::string> opened_text(std::string_view document, X509* signer);

}  // namespace biopsy::security
