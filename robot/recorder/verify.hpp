// Verifies a whole log: every record unaltered and in its place, and the head signed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <variant>

#include "robot/recorder/chain.hpp"

namespace biopsy::recorder {

enum class FlawKind : std::uint8_t {
  NotALog,           // another kind of file
  Damaged,           // SQLite cannot read on
  OtherKey,          // signed with another key than the one given
  HeadAltered,       // the signature does not hold
  RecordAltered,     // content and hash disagree
  RecordMissing,     // a number is left out
  RecordOutOfPlace,  // follows another record than the one before it: exchanged or spliced in
  RecordsCutOff,     // fewer than were signed
  RecordAdded,       // more than were signed
  Rewritten,         // a whole chain, but not the one that was signed
};

constexpr const char* name_of(FlawKind kind) {
  constexpr std::array<const char*, 10> kNames{
      "not a log",      "damaged",        "other key",           "head altered",
      "record altered", "record missing", "record out of place", "records cut off",
      "record added",   "rewritten"};
  return kNames[static_cast<std::size_t>(kind)];
}

struct Flaw {
  FlawKind kind = FlawKind::NotALog;
  std::uint64_t record = 0;  // where it shows; 0: the file or its head
  std::string what;          // a sentence
};

// The signed head of an intact log, or the first flaw.
using Verdict = std::variant<LogHead, Flaw>;

// Writes nothing, beside the log neither. A log that is being written is read as of the last commit. `each`
// is given every record that can be read, in order, also behind a flaw. Throws ConfigError where there is no
// file that can be opened.
Verdict verify(const std::filesystem::path& log, const PublicKey& key,
               const std::function<void(const Record&)>& each = {});

}  // namespace biopsy::recorder
