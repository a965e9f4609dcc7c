// Writes the procedure log: one SQLite file, a chain of hashes through its records and a signed head. Used by
// one thread, off the control path. Time is given, in microseconds of the recorder's monotonic clock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>
#include <string>

#include "robot/common/files/file_lock.hpp"
#include "robot/recorder/chain.hpp"
#include "robot/recorder/database.hpp"

namespace biopsy::recorder {

// Age of the oldest record at which a group is written. Requirement: on disk within 100 ms; 20 ms are left
// for the caller's period of 10 ms and for the disk.
inline constexpr std::int64_t kGroup_us = 80'000;
// Between attempts while writing fails.
inline constexpr std::int64_t kRetry_us = 20'000;
inline constexpr std::size_t kMemory_bytes = 32U << 20U;

class Recorder {
 public:
  // Makes the log where there is none; continues one that verifies with this key. Throws ConfigError: the log
  // does not verify (it is left as it is), another recorder writes it, the folder cannot be written.
  Recorder(const std::filesystem::path& log, SigningKey key, std::size_t memory_bytes = kMemory_bytes);

  // Keeps the record in memory; an urgent one is written at once, with all before it.
  void append(Entry entry, Urgency urgency, std::int64_t now_us) noexcept;
  // Writes what is due. To be called every 10 ms.
  void poll(std::int64_t now_us) noexcept;
  // Writes everything. False: some records are still in memory only.
  bool flush(std::int64_t now_us) noexcept;

  // Age of the oldest record that is not on disk; 0 where there is none.
  std::int64_t backlog_ms(std::int64_t now_us) const;
  // What is on disk: survives kill -9 and power failure.
  const LogHead& written() const { return head_; }
  // Why the last write failed; empty while all is well.
  const std::string& last_error() const { return last_error_; }

 private:
  struct Pending {
    Record record;  // its number and hashes are given when it is written
    std::int64_t arrived_us = 0;
  };
  // Records that found memory full: one record in their place counts them.
  struct Dropped {
    std::uint64_t records = 0, urgent = 0;
    std::int64_t first_utc_ns = 0, first_us = 0, last_us = 0;
  };

  static std::size_t cost(const Record& record);
  void keep(Record record, std::int64_t arrived_us);
  void drop(const Record& record, Urgency urgency, std::int64_t now_us);
  void write_drop_summary();
  void write_all(std::int64_t now_us);
  bool write_batch(std::ptrdiff_t records);
  bool insert(Record& record, LogHead& head);
  bool move_head(const LogHead& to);
  bool file_is_gone();

  SigningKey key_;
  std::filesystem::path log_;
  FileLock only_;
  LogHead head_;
  Database database_;
  Statement insert_, move_head_;
  std::size_t memory_bytes_, used_bytes_ = 0;
  std::deque<Pending> pending_;
  std::optional<Dropped> dropped_;  // only after pending records
  bool urgent_ = false;             // among the pending
  std::int64_t retry_us_ = 0;
  std::string last_error_;
};

}  // namespace biopsy::recorder
