#include "robot/recorder/verify.hpp"

#include <fmt/format.h>

#include <fstream>
#include <optional>
#include <system_error>

#include "robot/common/config_error.hpp"
#include "robot/common/text/number_text.hpp"
#include "robot/recorder/log_file.hpp"

namespace biopsy::recorder {
namespace {

namespace fs = std::filesystem;

fs::path readable(const fs::path& log) {
  std::error_code trouble;
  fs::path file = fs::canonical(log, trouble);
  if (trouble || !fs::is_regular_file(file) || !std::ifstream(file))
    throw ConfigError("there is no log that can be read", log.string(), "give the file of a procedure log");
  return file;
}

Flaw unreadable(const Database& database, int code, std::uint64_t record) {
  if (code == SQLITE_NOTADB) return {FlawKind::NotALog, 0, "this file is no procedure log"};
  const std::string where = record == 0 ? "" : fmt::format(" at record {} or before it", record);
  return {FlawKind::Damaged, record, fmt::format("the file cannot be read{}: {}", where, database.message())};
}

std::optional<Flaw> flaw_of_tables(const Database& database) {
  Statement schema(database, "SELECT sql FROM sqlite_schema ORDER BY name");
  int code = schema.step();
  for (const char* table : kTables) {
    if (code != SQLITE_ROW && code != SQLITE_DONE) return unreadable(database, code, 0);
    if (code == SQLITE_DONE || schema.text(0) != table)
      return Flaw{FlawKind::NotALog, 0, "its tables are not those of a procedure log"};
    code = schema.step();
  }
  if (code == SQLITE_DONE) return std::nullopt;
  return Flaw{FlawKind::NotALog, 0, "it holds more than the tables of a procedure log"};
}

Verdict head_of(const Database& database, const PublicKey& key) {
  Statement row(database, "SELECT one, log_id, public_key, count, last_hash, signature FROM head");
  if (const int code = row.step(); code != SQLITE_ROW && code != SQLITE_DONE)
    return unreadable(database, code, 0);
  LogHead head;
  PublicKey named{};
  Signature signature{};
  const auto count = row.integer(3);
  const bool whole = row.integer(0) == 1 && row.bytes(1, head.id) && row.bytes(2, named) && count &&
                     row.bytes(4, head.last_hash) && row.bytes(5, signature) && row.step() == SQLITE_DONE;
  if (!whole) return Flaw{FlawKind::HeadAltered, 0, "the signed head is not there as it was written"};
  head.count = static_cast<std::uint64_t>(*count);
  if (named != key) return Flaw{FlawKind::OtherKey, 0, "the log names another key than the one given"};
  if (!is_signed_by(key, view(signature), signed_bytes(head)))
    return Flaw{FlawKind::HeadAltered, 0, "the head was altered: its signature does not hold"};
  return head;
}

// The records in order; a column that is not as the recorder writes it is left empty and counted.
class Rows {
 public:
  explicit Rows(const Database& database)
      : rows_(database,
              "SELECT seq, utc_ns, mono_us, source, kind, body, previous, hash FROM record "
              "ORDER BY seq") {}

  // Nothing: at the end, or at what cannot be read; see `code`.
  std::optional<Record> next() {
    code_ = rows_.step();
    if (code_ != SQLITE_ROW) return std::nullopt;
    Record record;
    well_formed_ = true;
    record.seq = static_cast<std::uint64_t>(taken(rows_.integer(0)));
    record.utc_ns = taken(rows_.integer(1));
    record.mono_us = taken(rows_.integer(2));
    record.source = taken(rows_.text(3));
    record.kind = taken(rows_.text(4));
    record.body = taken(rows_.text(5));
    well_formed_ = rows_.bytes(6, record.previous) && well_formed_;
    well_formed_ = rows_.bytes(7, record.hash) && well_formed_;
    return record;
  }
  bool well_formed() const { return well_formed_; }
  int code() const { return code_; }

 private:
  template <class Value>
  Value taken(std::optional<Value> value) {
    well_formed_ = well_formed_ && value;
    return std::move(value).value_or(Value{});
  }

  Statement rows_;
  int code_ = SQLITE_OK;
  bool well_formed_ = true;
};

// `chain` is at the record before.
std::optional<Flaw> flaw_of(const Record& record, bool well_formed, const LogHead& chain) {
  const std::uint64_t due = chain.count + 1;
  if (record.seq > due)
    return Flaw{FlawKind::RecordMissing, due,
                record.seq == due + 1 ? fmt::format("record {} is missing", due)
                                      : fmt::format("records {} to {} are missing", due, record.seq - 1)};
  if (!well_formed || record.seq != due || hash_of(record) != record.hash)
    return Flaw{FlawKind::RecordAltered, due,
                fmt::format("record {} was altered: its content does not give its hash", due)};
  if (record.previous != chain.last_hash)
    return Flaw{FlawKind::RecordOutOfPlace, due,
                fmt::format("record {} does not follow the one before it: records were exchanged", due)};
  return std::nullopt;
}

std::optional<Flaw> flaw_of_end(const LogHead& chain, const LogHead& head) {
  if (chain.count < head.count)
    return Flaw{
        FlawKind::RecordsCutOff, chain.count + 1,
        fmt::format("{} signed, {} there: the end is missing", counted(head.count, "record"), chain.count)};
  if (chain.count > head.count)
    return Flaw{
        FlawKind::RecordAdded, head.count + 1,
        fmt::format("{} signed, {} there: the end was added", counted(head.count, "record"), chain.count)};
  if (chain.last_hash != head.last_hash)
    return Flaw{FlawKind::Rewritten, chain.count,
                "the records are not those that were signed: the chain ends in another hash"};
  return std::nullopt;
}

// Of the log's files: what a writer changes.
struct FileTimes {
  std::uintmax_t size = 0, wal_size = 0;
  fs::file_time_type changed{}, wal_changed{};

  bool operator==(const FileTimes&) const = default;
};

FileTimes times_of(const fs::path& log) {
  std::error_code absent;
  return {fs::file_size(log, absent), fs::file_size(wal_of(log), absent), fs::last_write_time(log, absent),
          fs::last_write_time(wal_of(log), absent)};
}

Verdict verify_once(const fs::path& file, const PublicKey& key,
                    const std::function<void(const Record&)>& each) {
  // Beside an empty file SQLite would delete the WAL.
  if (fs::file_size(file) == 0) return Flaw{FlawKind::NotALog, 0, "the file is empty"};
  int code = SQLITE_OK;
  const Database database = open_for_reading(file, &code);
  if (code != SQLITE_OK) return unreadable(database, code, 0);
  if (auto flaw = flaw_of_tables(database)) return *flaw;

  Verdict verdict = head_of(database, key);
  const auto* head = std::get_if<LogHead>(&verdict);
  LogHead chain = head ? empty_head(head->id, key) : LogHead{};
  std::optional<Flaw> flaw;
  Rows rows(database);
  while (const auto record = rows.next()) {
    if (head && !flaw) flaw = flaw_of(*record, rows.well_formed(), chain);
    chain.count += 1;
    chain.last_hash = record->hash;
    if (each) each(*record);
  }
  if (!flaw && rows.code() != SQLITE_DONE) flaw = unreadable(database, rows.code(), chain.count + 1);
  if (head && !flaw) flaw = flaw_of_end(chain, *head);
  if (head && flaw) return *flaw;
  return verdict;
}

// Nothing could be read, and not a record was passed on.
bool is_unreadable(const Verdict& verdict) {
  const auto* flaw = std::get_if<Flaw>(&verdict);
  return flaw != nullptr && flaw->kind == FlawKind::Damaged && flaw->record == 0;
}

}  // namespace

// How a log is opened follows from the files beside it. A recorder that makes or drops one of them in that
// moment leaves a reading that fails: it is taken again, as long as the files go on changing.
Verdict verify(const fs::path& log, const PublicKey& key, const std::function<void(const Record&)>& each) {
  constexpr int kReadingsMax = 50;
  const fs::path file = readable(log);
  for (int reading = 1;; ++reading) {
    const FileTimes before = times_of(file);
    Verdict verdict = verify_once(file, key, each);
    if (!is_unreadable(verdict) || reading == kReadingsMax || times_of(file) == before) return verdict;
  }
}

}  // namespace biopsy::recorder
