// Where the messages of this program go, from main's beginning to its end.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "robot/common/logging/level.hpp"

namespace biopsy::logging {

enum class Format : std::uint8_t { Text, Json };

struct LogSettings {
  std::string program;              // "biopsy-stage": stands in JSON lines
  std::optional<Level> level;       // of file and stderr; none: info in the file, warnings on stderr
  Format format = Format::Text;     // JSON: one object a line
  std::filesystem::path file;       // grows to 5 MB, then is rotated, two older ones are kept; empty: none
  int stream = 2;                   // stderr; journald's priority prefix where journald reads it
  std::size_t queue_length = 4096;  // messages
  std::chrono::milliseconds patience{1000};  // of flush() and of the end, with an output that is blocked
};

inline constexpr const char* kLevelVariable = "BIOPSY_LOG_LEVEL";
inline constexpr const char* kFormatVariable = "BIOPSY_LOG_FORMAT";

// Throw ConfigError naming `where` for a word that is none.
Level level_of(const std::string& word, const std::string& where);
Format format_of(const std::string& word, const std::string& where);

// Level and format from the environment, where it has them. Throws ConfigError.
LogSettings settings_from_environment(std::string program);

// One at a time. Make it before any other thread is started; its own threads take no signals. A file that
// cannot be opened is a warning on stderr, never an error: diagnostics stop nothing.
class LogSession {
 public:
  explicit LogSession(const LogSettings& settings);
  ~LogSession();  // flushes; what an output that stays blocked has not taken is lost
  LogSession(const LogSession&) = delete;
  LogSession& operator=(const LogSession&) = delete;

  // Waits until all messages so far are written. False: an output is blocked.
  bool flush();
};

// Adds the file to a session that has none, once the run folder is known. Without a session: nothing.
void log_to_file(const std::filesystem::path& file);

}  // namespace biopsy::logging
