#include "robot/recorder/chain.hpp"

#include <span>

#include "robot/common/byte_writer.hpp"
#include "robot/common/sha256.hpp"

namespace biopsy::recorder {

LogHead empty_head(const LogId& id, const PublicKey& key) {
  ByteWriter first;
  first.text("biopsy-log-1").raw(id).raw(key);
  return {id, 0, sha256(std::as_bytes(std::span(first.bytes())))};
}

Sha256 hash_of(const Record& record) {
  ByteWriter to;
  to.text("biopsy-log-record-1").raw(record.previous).integer(record.seq);
  to.integer(static_cast<std::uint64_t>(record.utc_ns)).integer(static_cast<std::uint64_t>(record.mono_us));
  to.text(record.source).text(record.kind).text(record.body);
  return sha256(std::as_bytes(std::span(to.bytes())));
}

std::string signed_bytes(const LogHead& head) {
  ByteWriter to;
  to.text("biopsy-log-head-1").raw(head.id).integer(head.count).raw(head.last_hash);
  return {to.bytes().begin(), to.bytes().end()};
}

}  // namespace biopsy::recorder
