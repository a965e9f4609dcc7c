#include "robot/recorder/database.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace biopsy::recorder {

Database::Database(const std::string& uri, int flags, int* code) {
  sqlite3* connection = nullptr;
  *code = sqlite3_open_v2(uri.c_str(), &connection, flags | SQLITE_OPEN_URI, nullptr);
  connection_.reset(connection);
}

void Database::Close::operator()(sqlite3* connection) const {
  sqlite3_close_v2(connection);
}

int Database::execute(const char* sql) {
  return sqlite3_exec(handle(), sql, nullptr, nullptr, nullptr);
}

int Database::configure(int option, int value) {
  return sqlite3_db_config(handle(), option, value, nullptr);
}

std::string Database::message() const {
  return sqlite3_errmsg(handle());
}

Statement::Statement(const Database& database, const char* sql) {
  sqlite3_stmt* statement = nullptr;
  prepared_ = sqlite3_prepare_v2(database.handle(), sql, -1, &statement, nullptr);
  statement_.reset(statement);
}

void Statement::Finalise::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

void Statement::bind(int at, std::int64_t value) {
  sqlite3_bind_int64(statement_.get(), at, value);
}

void Statement::bind(int at, std::string_view text) {
  sqlite3_bind_text64(statement_.get(), at, text.data(), text.size(), SQLITE_STATIC, SQLITE_UTF8);
}

void Statement::bind(int at, std::span<const std::uint8_t> bytes) {
  sqlite3_bind_blob64(statement_.get(), at, bytes.data(), bytes.size(), SQLITE_STATIC);
}

int Statement::step() {
  return prepared_ == SQLITE_OK ? sqlite3_step(statement_.get()) : prepared_;
}

bool Statement::finish() {
  const bool done = step() == SQLITE_DONE;
  sqlite3_reset(statement_.get());
  return done;
}

std::optional<std::int64_t> Statement::integer(int column) const {
  if (sqlite3_column_type(statement_.get(), column) != SQLITE_INTEGER) return std::nullopt;
  return sqlite3_column_int64(statement_.get(), column);
}

std::optional<std::string> Statement::text(int column) const {
  if (sqlite3_column_type(statement_.get(), column) != SQLITE_TEXT) return std::nullopt;
  const auto* letters = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
  if (!letters) return std::nullopt;
  return std::string(letters, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column)));
}

bool Statement::bytes(int column, std::span<std::uint8_t> to) const {
  if (sqlite3_column_type(statement_.get(), column) != SQLITE_BLOB) return false;
  const auto* from = static_cast<const std::uint8_t*>(sqlite3_column_blob(statement_.get(), column));
  if (!from || sqlite3_column_bytes(statement_.get(), column) != static_cast<int>(to.size())) return false;
  std::copy_n(from, to.size(), to.begin());
  return true;
}

std::string database_uri(const std::string& path) {
  std::string uri = "file:";
  for (const char letter : path) {
    const auto byte = static_cast<unsigned char>(letter);
    if (std::isalnum(byte) || letter == '/' || letter == '.' || letter == '-' || letter == '_')
      uri += letter;
    else
      uri += fmt::format("%{:02X}", byte);
  }
  return uri;
}

}  // namespace biopsy::recorder
