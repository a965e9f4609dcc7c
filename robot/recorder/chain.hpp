// The hash chain of the records, and the signed head. Serialisation: integers 64 bits, little-endian; texts
// with a 64-bit length before them; identities and hashes as they are.
//
//   first    = SHA-256( "biopsy-log-1", log id [16], public key [32] )
//   hash     = SHA-256( "biopsy-log-record-1", previous [32], seq, utc_ns, mono_us, source, kind, body )
//   previous = hash of the record before; `first` for record 1
//   head     = Ed25519( "biopsy-log-head-1", log id [16], count, last hash [32] )
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "robot/common/ed25519.hpp"
#include "robot/recorder/record.hpp"

namespace biopsy::recorder {

using LogId = std::array<std::uint8_t, 16>;  // random, one a log

struct LogHead {
  LogId id{};
  std::uint64_t count = 0;  // records
  Sha256 last_hash{};       // of the last; of an empty log: `first`

  bool operator==(const LogHead&) const = default;
};

// The head of a log without records.
LogHead empty_head(const LogId& id, const PublicKey& key);

// Over everything in the record but `hash`.
Sha256 hash_of(const Record& record);

// What the signature is over.
std::string signed_bytes(const LogHead& head);

}  // namespace biopsy::recorder
