#include "robot/recorder/log_file.hpp"

#include <cstdint>
#include <string>
#include <system_error>

namespace biopsy::recorder {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kWalHeader_bytes = 32;  // not longer: nothing was committed to it

// Three cases, because SQLite's read-only mode alone would create, fill or delete files beside the log:
//  - WAL and shared memory: a live log, read under the writer's locks, or that of a killed recorder. (With a
//    WAL that is only a header SQLite 3.40 fails with "locking protocol" after 10 s.)
//  - WAL alone: a copy. Its index is built on the heap, which SQLite does for exclusive connections; the VFS
//    without locks allows that for a read-only one.
//  - no WAL: the file alone is the log.
std::string reading_options(const fs::path& log) {
  std::error_code absent;
  const std::uintmax_t size = fs::file_size(wal_of(log), absent);
  const bool shared = !absent && fs::exists(log.string() + "-shm", absent);
  if (shared && size != kWalHeader_bytes) return "?mode=ro&readonly_shm=1";
  return !absent && size > kWalHeader_bytes ? "?mode=ro&vfs=unix-none" : "?mode=ro&immutable=1";
}

}  // namespace

fs::path public_key_beside(const fs::path& log) {
  return log.string() + ".pub.pem";
}

fs::path wal_of(const fs::path& log) {
  return log.string() + "-wal";
}

Database open_for_reading(const fs::path& log, int* code) {
  const std::string options = reading_options(log);
  Database database(database_uri(log.string()) + options, SQLITE_OPEN_READONLY, code);
  if (*code != SQLITE_OK) return database;
  database.configure(SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1);
  database.configure(SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0);
  database.configure(SQLITE_DBCONFIG_DEFENSIVE, 1);
  sqlite3_busy_timeout(database.handle(), 2000);
  if (options.ends_with("unix-none")) database.execute("PRAGMA locking_mode = EXCLUSIVE");
  *code = database.execute("BEGIN");  // one snapshot for the whole reading
  return database;
}

}  // namespace biopsy::recorder
