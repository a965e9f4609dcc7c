// Alarms that are and that were, with their times: kept in a file, so that a page that is opened again and a
// console that is started again still show them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "robot/msg/console_messages.hpp"

namespace biopsy::console {

class AlarmHistory {
 public:
  static constexpr std::size_t kRowsMax = 200;

  // Reads what an earlier console kept; whether what was active then still is, the first update says. Lines
  // that cannot be read (the last one, after a crash) are left out. Throws ConfigError where the file cannot
  // be written.
  explicit AlarmHistory(std::filesystem::path file);

  // The alarms of this moment. The same alarm has the same code and words. Times are ms since 1970.
  void update(const std::vector<events::Alarm>& active, std::int64_t now_ms);
  // One that ends at once: a refused command.
  void note(const events::Alarm& alarm, std::int64_t now_ms);
  // By a person: all that are active, up to row `newest`.
  void acknowledge(std::uint32_t newest, std::int64_t now_ms);

  const events::AlarmHistory& event() const { return event_; }  // newest first
  std::uint32_t version() const { return version_; }            // increases with every change

 private:
  void begin(const events::Alarm& alarm, double from_ms, double to_ms);
  void keep(const events::PastAlarm& row);

  std::filesystem::path file_;
  events::AlarmHistory event_;
  std::uint32_t version_ = 1, rows_ = 0;
};

}  // namespace biopsy::console
