#include "robot/recorder/chain.hpp"

#include <openssl/evp.h>

#include <cstdio>
#include <cstdlib>
#include <span>

namespace biopsy::recorder {
namespace {

class Serialiser {
 public:
  Serialiser& integer(std::uint64_t value) {
    for (int shift = 0; shift < 64; shift += 8) bytes_ += static_cast<char>(value >> shift);
    return *this;
  }
  Serialiser& text(std::string_view value) {
    integer(value.size());
    bytes_ += value;
    return *this;
  }
  Serialiser& raw(std::span<const std::uint8_t> value) {
    bytes_.append(value.begin(), value.end());
    return *this;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

Sha256 sha256(const std::string& bytes) {
  Sha256 digest{};
  unsigned int length = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &length, EVP_sha256(), nullptr) != 1 ||
      length != digest.size()) {
    std::fputs("SHA-256 is not available in this build of OpenSSL\n", stderr);
    std::abort();
  }
  return digest;
}

}  // namespace

LogHead empty_head(const LogId& id, const PublicKey& key) {
  Serialiser first;
  first.text("biopsy-log-1").raw(id).raw(key);
  return {id, 0, sha256(first.bytes())};
}

Sha256 hash_of(const Record& record) {
  Serialiser to;
  to.text("biopsy-log-record-1").raw(record.previous).integer(record.seq);
  to.integer(static_cast<std::uint64_t>(record.utc_ns)).integer(static_cast<std::uint64_t>(record.mono_us));
  to.text(record.source).text(record.kind).text(record.body);
  return sha256(to.bytes());
}

std::string signed_bytes(const LogHead& head) {
  Serialiser to;
  to.text("biopsy-log-head-1").raw(head.id).integer(head.count).raw(head.last_hash);
  return to.bytes();
}

}  // namespace biopsy::recorder
