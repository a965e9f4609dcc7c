#include "robot/security/openssl_handles.hpp"

#include <fmt/format.h>
#include <openssl/err.h>

#include <array>

#include "robot/common/logging/logger.hpp"

namespace biopsy::security {

Bio reader(std::string_view bytes) {
  Bio bio(BIO_new_mem_buf(bytes.data(), static_cast<int>(bytes.size())));
  must(bio != nullptr, "read memory");
  return bio;
}

Bio writer() {
  Bio bio(BIO_new(BIO_s_mem()));
  must(bio != nullptr, "write memory");
  return bio;
}

std::string written(const Bio& bio) {
  char* bytes = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &bytes);
  return size > 0 ? std::string(bytes, static_cast<std::size_t>(size)) : std::string();
}

void must(bool succeeded, const char* doing) {
  if (succeeded) return;
  std::array<char, 256> reason{};
  ERR_error_string_n(ERR_get_error(), reason.data(), reason.size());
  logging::fatal(logging::Component::Security, fmt::format("OpenSSL could not {}: {}", doing, reason.data()));
}

}  // namespace biopsy::security
