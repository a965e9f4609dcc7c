#include "robot/recorder/recorder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <variant>

#include "robot/common/config_error.hpp"
#include "robot/recorder/log_file.hpp"
#include "robot/recorder/new_log.hpp"
#include "robot/recorder/verify.hpp"

namespace biopsy::recorder {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBatch = 1024;  // records of one transaction

fs::path existing(const fs::path& log, const SigningKey& key) {
  if (!fs::exists(log)) make_log(log, key);
  return fs::canonical(log);
}

// Before it is opened for writing: a log that was altered stays as it was found.
LogHead verified_head(const fs::path& log, const PublicKey& key) {
  const Verdict verdict = verify(log, key);
  if (const auto* flaw = std::get_if<Flaw>(&verdict))
    throw ConfigError("nothing is added to a log that does not verify: " + flaw->what, log.string(),
                      "move it aside, with its -wal and -shm files, and keep it; a new one is made");
  return std::get<LogHead>(verdict);
}

Database open_for_writing(const fs::path& log) {
  int code = SQLITE_OK;
  Database database(database_uri(log.string()), SQLITE_OPEN_READWRITE, &code);
  if (code == SQLITE_OK) database.configure(SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0);
  // FULL: SQLite syncs the WAL with each commit, so that it survives a power failure too.
  if (code != SQLITE_OK || database.execute("PRAGMA journal_mode = WAL") != SQLITE_OK ||
      database.execute("PRAGMA synchronous = FULL; BEGIN IMMEDIATE; ROLLBACK") != SQLITE_OK)
    throw ConfigError("the log cannot be written: " + database.message(), log.string(),
                      "choose a log and a folder that this user may write");
  return database;
}

}  // namespace

Recorder::Recorder(const fs::path& log, SigningKey key, std::size_t memory_bytes)
    : key_(std::move(key)),
      log_(existing(log, key_)),
      only_(log_),
      head_(verified_head(log_, key_.public_key())),
      database_(open_for_writing(log_)),
      insert_(database_, "INSERT INTO record VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)"),
      move_head_(database_,
                 "UPDATE head SET count = ?1, last_hash = ?2, signature = ?3 "
                 "WHERE count = ?4 AND last_hash = ?5"),
      memory_bytes_(memory_bytes) {}

void Recorder::append(Entry entry, Urgency urgency, std::int64_t now_us) noexcept {
  Record record{.utc_ns = entry.utc_ns,
                .mono_us = entry.mono_us,
                .source = std::move(entry.source),
                .kind = name_of(entry.kind),
                .body = std::move(entry.body)};
  // After a dropped record the next are dropped too, until their number is written: the order holds.
  if (dropped_ || used_bytes_ + cost(record) > memory_bytes_)
    drop(record, urgency, now_us);
  else
    keep(std::move(record), now_us);
  if (urgency != Urgency::Urgent) return;
  urgent_ = true;
  poll(now_us);
}

void Recorder::poll(std::int64_t now_us) noexcept {
  if (pending_.empty() || now_us < retry_us_) return;
  if (urgent_ || now_us - pending_.front().arrived_us >= kGroup_us) write_all(now_us);
}

bool Recorder::flush(std::int64_t now_us) noexcept {
  write_all(now_us);
  return pending_.empty();
}

std::int64_t Recorder::backlog_ms(std::int64_t now_us) const {
  return pending_.empty() ? 0 : std::max<std::int64_t>(0, (now_us - pending_.front().arrived_us) / 1000);
}

std::size_t Recorder::cost(const Record& record) {
  return sizeof(Pending) + record.source.size() + record.kind.size() + record.body.size();
}

void Recorder::keep(Record record, std::int64_t arrived_us) {
  used_bytes_ += cost(record);
  pending_.push_back({std::move(record), arrived_us});
}

void Recorder::drop(const Record& record, Urgency urgency, std::int64_t now_us) {
  if (!dropped_) dropped_ = Dropped{.first_utc_ns = record.utc_ns, .first_us = now_us};
  dropped_->records += 1;
  dropped_->urgent += urgency == Urgency::Urgent ? 1 : 0;
  dropped_->last_us = now_us;
  write_drop_summary();
}

// After the last record that was kept.
void Recorder::write_drop_summary() {
  if (!dropped_ || !pending_.empty()) return;
  const Dropped dropped = *std::exchange(dropped_, std::nullopt);
  keep({.utc_ns = dropped.first_utc_ns,
        .mono_us = dropped.first_us,
        .source = "recorder",
        .kind = name_of(RecordKind::RecordsLost),
        .body = fmt::format(R"({{"records":{},"urgent":{},"first_us":{},"last_us":{}}})", dropped.records,
                            dropped.urgent, dropped.first_us, dropped.last_us)},
       dropped.first_us);
}

void Recorder::write_all(std::int64_t now_us) {
  while (!pending_.empty()) {
    const auto batch = static_cast<std::ptrdiff_t>(std::min(kBatch, pending_.size()));
    if (!write_batch(batch)) {
      retry_us_ = now_us + kRetry_us;
      return;
    }
    std::for_each_n(pending_.begin(), batch, [&](const Pending& one) { used_bytes_ -= cost(one.record); });
    pending_.erase(pending_.begin(), pending_.begin() + batch);
    write_drop_summary();
  }
  urgent_ = false;
  last_error_.clear();
}

// Records and head in one transaction: on disk are both or neither.
bool Recorder::write_batch(std::ptrdiff_t records) {
  LogHead head = head_;
  bool done = !file_is_gone() && database_.execute("BEGIN IMMEDIATE") == SQLITE_OK;
  for (std::ptrdiff_t n = 0; done && n < records; ++n) done = insert(pending_[n].record, head);
  done = done && move_head(head) && database_.execute("COMMIT") == SQLITE_OK;
  if (done) {
    head_ = head;
    return true;
  }
  if (sqlite3_errcode(database_.handle()) != SQLITE_OK) last_error_ = database_.message();
  if (!sqlite3_get_autocommit(database_.handle())) database_.execute("ROLLBACK");
  return false;
}

bool Recorder::insert(Record& record, LogHead& head) {
  record.seq = head.count + 1;
  record.previous = head.last_hash;
  record.hash = hash_of(record);
  head.count = record.seq;
  head.last_hash = record.hash;
  insert_.bind(1, static_cast<std::int64_t>(record.seq));
  insert_.bind(2, record.utc_ns);
  insert_.bind(3, record.mono_us);
  insert_.bind(4, record.source);
  insert_.bind(5, record.kind);
  insert_.bind(6, record.body);
  insert_.bind(7, record.previous);
  insert_.bind(8, record.hash);
  return insert_.finish();
}

// Only from where this recorder left it: two chains are never mixed.
bool Recorder::move_head(const LogHead& to) {
  const Signature signature = key_.sign(signed_bytes(to));
  move_head_.bind(1, static_cast<std::int64_t>(to.count));
  move_head_.bind(2, to.last_hash);
  move_head_.bind(3, signature);
  move_head_.bind(4, static_cast<std::int64_t>(head_.count));
  move_head_.bind(5, head_.last_hash);
  if (!move_head_.finish()) return false;
  if (sqlite3_changes(database_.handle()) == 1) return true;
  last_error_ = "another program wrote to the log";
  return false;
}

// SQLite would go on writing to the unlinked file, which is lost when the process ends.
bool Recorder::file_is_gone() {
  int moved = 0;
  sqlite3_file_control(database_.handle(), "main", SQLITE_FCNTL_HAS_MOVED, &moved);
  if (moved) last_error_ = "the log's file was moved or deleted";
  return moved != 0;
}

}  // namespace biopsy::recorder
