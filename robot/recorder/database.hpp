// An SQLite connection and its statements, closed when they go out of scope. Results are SQLite's codes.
#pragma once

#include <sqlite3.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace biopsy::recorder {

class Database {
 public:
  // `uri` as SQLite takes it, "file:..." with the path encoded. Check `code` first.
  Database(const std::string& uri, int flags, int* code);

  int execute(const char* sql);
  int configure(int option, int value);
  // Of the last call that failed.
  std::string message() const;
  sqlite3* handle() const { return connection_.get(); }

 private:
  struct Close {
    void operator()(sqlite3* connection) const;
  };
  std::unique_ptr<sqlite3, Close> connection_;
};

class Statement {
 public:
  // For SQL that does not fit the file, step() fails.
  Statement(const Database& database, const char* sql);

  // From 1, as in SQL.
  void bind(int at, std::int64_t value);
  void bind(int at, std::string_view text);  // not copied: must live until the step
  void bind(int at, std::span<const std::uint8_t> bytes);

  // SQLITE_ROW, SQLITE_DONE or an error.
  int step();
  // Runs it to its end and resets it.
  bool finish();

  // From 0; empty where the column has another type, or another number of bytes.
  std::optional<std::int64_t> integer(int column) const;
  std::optional<std::string> text(int column) const;
  bool bytes(int column, std::span<std::uint8_t> to) const;

 private:
  struct Finalise {
    void operator()(sqlite3_stmt* statement) const;
  };
  std::unique_ptr<sqlite3_stmt, Finalise> statement_;
  int prepared_;
};

// "file:/a%20b" of a path: characters with a meaning in URIs are encoded.
std::string database_uri(const std::string& path);

}  // namespace biopsy::recorder
