// Logs of some records, and SQL that alters them.
#pragma once

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>
#include <string>
#include <vector>

#include "robot/recorder/log_file.hpp"
#include "robot/recorder/recorder.hpp"
#include "robot/recorder/verify.hpp"
#include "tests/key_files.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::recorder {

inline constexpr std::int64_t kMs = 1000;  // in us

namespace fs = std::filesystem;

inline Entry entry(std::int64_t n, std::string body = "") {
  constexpr std::int64_t kNovember2026_ns = 1'795'000'000'000'000'000;
  if (body.empty()) body = R"({"n":)" + std::to_string(n) + R"(,"state":"hold"})";
  return {.utc_ns = kNovember2026_ns + n * 1'000'000,
          .mono_us = n * 1000,
          .source = n % 2 ? "supervisor" : "stage",
          .kind = static_cast<RecordKind>(n % static_cast<std::int64_t>(kRecordKinds)),
          .body = std::move(body)};
}

// A folder with a key and, with `records`, a closed log.
struct LogFolder {
  LogFolder() { make_key_files(scratch / "key.pem"); }
  explicit LogFolder(std::int64_t records) : LogFolder() { write(log, records); }

  SigningKey key() const { return SigningKey(scratch / "key.pem"); }
  PublicKey public_key() const { return key().public_key(); }
  void write(const fs::path& file, std::int64_t records) const {
    Recorder recorder(file, key());
    for (std::int64_t n = 1; n <= records; ++n) recorder.append(entry(n), Urgency::Grouped, 0);
    ASSERT_TRUE(recorder.flush(0)) << recorder.last_error();
  }
  Verdict verdict() const { return verify(log, public_key()); }

  ScratchFolder scratch;
  fs::path log = scratch / "procedure.log";
};

inline std::vector<Record> records_of(const fs::path& log, const PublicKey& key) {
  std::vector<Record> records;
  (void)verify(log, key, [&](const Record& record) { records.push_back(record); });
  return records;
}

inline bool is_intact(const Verdict& verdict) {
  return std::holds_alternative<LogHead>(verdict);
}

inline std::uint64_t count_of(const Verdict& verdict) {
  const auto* head = std::get_if<LogHead>(&verdict);
  return head ? head->count : 0;
}

inline std::string text_of(const Verdict& verdict) {
  const auto* flaw = std::get_if<Flaw>(&verdict);
  return flaw ? std::string(name_of(flaw->kind)) + " " + std::to_string(flaw->record) : "intact";
}

// SQL on the file, which is then closed so that no WAL remains.
inline void tamper(const fs::path& log, const std::string& sql) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(log.c_str(), &database), SQLITE_OK);
  char* message = nullptr;
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, &message), SQLITE_OK)
      << (message ? message : "") << "\n"
      << sql;
  sqlite3_free(message);
  sqlite3_close(database);
}

}  // namespace biopsy::recorder
