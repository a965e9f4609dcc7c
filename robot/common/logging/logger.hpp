// Diagnostic messages of all programs: docs/reference/diagnostic-log.md. The tamper-evident procedure log is
// robot/recorder.
//
// A call formats its message, puts it into a bounded queue and returns: it waits for no disk and no terminal.
// A full queue drops its oldest message, and the number dropped is logged. A call may allocate and takes a
// short lock, so that nothing in a control tick may call it: tick_log.hpp is for those.
#pragma once

#include <fmt/core.h>

#include <chrono>
#include <string_view>

#include "robot/common/logging/level.hpp"

namespace biopsy::logging {

// Whether any output takes messages of this level. Without a LogSession: warnings and errors, on stderr.
bool is_enabled(Level level) noexcept;

void write(Component component, Level level, std::string_view text) noexcept;
// With the time at which it happened, where that was before now.
void write(Component component, Level level, std::string_view text,
           std::chrono::system_clock::time_point time) noexcept;

// For what cannot be and cannot be continued from: logs an error, waits up to a second for it to be written,
// and aborts.
[[noreturn]] void fatal(Component component, std::string_view text) noexcept;

// The logger of a component: constexpr, no state.
class Logger {
 public:
  explicit constexpr Logger(Component component) : component_(component) {}

  template <class... Values>
  void debug(fmt::format_string<Values...> format, Values&&... values) const {
    log(Level::Debug, format, fmt::make_format_args(values...));
  }
  template <class... Values>
  void info(fmt::format_string<Values...> format, Values&&... values) const {
    log(Level::Info, format, fmt::make_format_args(values...));
  }
  template <class... Values>
  void warning(fmt::format_string<Values...> format, Values&&... values) const {
    log(Level::Warning, format, fmt::make_format_args(values...));
  }
  template <class... Values>
  void error(fmt::format_string<Values...> format, Values&&... values) const {
    log(Level::Error, format, fmt::make_format_args(values...));
  }

 private:
  void log(Level level, fmt::string_view format, fmt::format_args values) const;

  Component component_;
};

}  // namespace biopsy::logging
