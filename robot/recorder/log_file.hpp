// The SQLite file of a log: its tables, and how it is opened to be read.
#pragma once

#include <array>
#include <filesystem>

#include "robot/recorder/database.hpp"

namespace biopsy::recorder {

// In the folder of a robot.
inline constexpr const char* kLogName = "procedure.log.sqlite";

// All of sqlite_schema, ordered by name. With a further trigger, view or column the file is no procedure log.
inline constexpr std::array<const char*, 2> kTables{
    "CREATE TABLE head(one INTEGER PRIMARY KEY, log_id BLOB NOT NULL, public_key BLOB NOT NULL, "
    "count INTEGER NOT NULL, last_hash BLOB NOT NULL, signature BLOB NOT NULL) STRICT",
    "CREATE TABLE record(seq INTEGER PRIMARY KEY, utc_ns INTEGER NOT NULL, mono_us INTEGER NOT NULL, "
    "source TEXT NOT NULL, kind TEXT NOT NULL, body TEXT NOT NULL, previous BLOB NOT NULL, "
    "hash BLOB NOT NULL) STRICT"};

// A copy of the public key is written beside a new log. For evidence take the key from elsewhere.
std::filesystem::path public_key_beside(const std::filesystem::path& log);

// The last transactions may still be in the log's "-wal" file.
std::filesystem::path wal_of(const std::filesystem::path& log);

// Changes no byte of the log and the files beside it, also while a recorder writes it or after one was
// killed. `log`: canonical.
Database open_for_reading(const std::filesystem::path& log, int* code);

}  // namespace biopsy::recorder
