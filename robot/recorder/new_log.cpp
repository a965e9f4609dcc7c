#include "robot/recorder/new_log.hpp"

#include <openssl/rand.h>
#include <unistd.h>

#include <fstream>
#include <string>
#include <system_error>

#include "robot/common/config_error.hpp"
#include "robot/recorder/chain.hpp"
#include "robot/recorder/log_file.hpp"

namespace biopsy::recorder {
namespace {

namespace fs = std::filesystem;

// Under a temporary name of its own: a process killed half-way leaves the log's name free.
fs::path unfinished(const fs::path& file) {
  return file.string() + ".part" + std::to_string(::getpid());
}

bool write_tables(const fs::path& file, const SigningKey& key) {
  int code = SQLITE_OK;
  Database database(database_uri(fs::absolute(file).string()), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE,
                    &code);
  if (code != SQLITE_OK || database.execute("PRAGMA journal_mode = WAL; BEGIN") != SQLITE_OK) return false;
  for (const char* table : kTables)
    if (database.execute(table) != SQLITE_OK) return false;

  LogId id{};
  if (RAND_bytes(id.data(), static_cast<int>(id.size())) != 1) return false;
  const LogHead head = empty_head(id, key.public_key());
  const PublicKey public_key = key.public_key();
  const Signature signature = key.sign(signed_bytes(head));
  Statement insert(database, "INSERT INTO head VALUES (1, ?1, ?2, 0, ?3, ?4)");
  insert.bind(1, head.id);
  insert.bind(2, public_key);
  insert.bind(3, head.last_hash);
  insert.bind(4, signature);
  return insert.step() == SQLITE_DONE && database.execute("COMMIT") == SQLITE_OK;
}

bool write_key(const fs::path& file, const SigningKey& key) {
  std::ofstream stream(file, std::ios::binary);
  stream << pem_of(key.public_key());
  stream.close();
  return static_cast<bool>(stream);
}

}  // namespace

void make_log(const fs::path& log, const SigningKey& key) {
  std::error_code trouble;
  if (fs::exists(wal_of(log)))
    throw ConfigError("the last records of another log lie here without it", wal_of(log).string(),
                      "put that log back, or move this file aside");
  if (log.has_parent_path()) fs::create_directories(log.parent_path(), trouble);
  const fs::path new_log = unfinished(log), new_key = unfinished(public_key_beside(log));
  if (write_tables(new_log, key) && write_key(new_key, key)) {
    fs::rename(new_key, public_key_beside(log), trouble);
    if (!trouble) fs::rename(new_log, log, trouble);
    if (!trouble) return;
  }
  for (const fs::path& half : {new_log, wal_of(new_log), fs::path(new_log.string() + "-shm"), new_key})
    fs::remove(half, trouble);
  throw ConfigError("cannot make the procedure log", log.string(),
                    "choose a folder that can be written, on a disk with free space");
}

}  // namespace biopsy::recorder
