#include "robot/console/server/alarm_history.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <utility>

#include "robot/common/files/file.hpp"

namespace biopsy::console {

namespace {

bool is_same(const events::Alarm& one, const events::Alarm& other) {
  return one.code == other.code && one.what == other.what;
}

bool is_active(const events::PastAlarm& row) {
  return row.to_ms == 0.0;
}

std::string line_of(const events::PastAlarm& row) {
  return nlohmann::json(row).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) + "\n";
}

// A row is written again when it changes: the last line of its number counts.
std::vector<events::PastAlarm> rows_of(const std::string& kept) {
  std::vector<events::PastAlarm> rows;
  std::istringstream lines(kept);
  for (std::string line; std::getline(lines, line);) {
    const nlohmann::json json = nlohmann::json::parse(line, nullptr, false);
    events::PastAlarm row;
    try {
      FieldReader fields(json);
      read_fields(fields, row);
      fields.expect_no_more();
    } catch (const MessageFault&) {
      continue;
    }
    const auto known =
        std::find_if(rows.begin(), rows.end(), [&](const auto& one) { return one.number == row.number; });
    known == rows.end() ? rows.push_back(std::move(row)) : static_cast<void>(*known = std::move(row));
  }
  return rows;
}

}  // namespace

AlarmHistory::AlarmHistory(std::filesystem::path file) : file_(std::move(file)) {
  std::vector<events::PastAlarm> rows = rows_of(read_file_if_present(file_));
  if (rows.size() > kRowsMax) rows.erase(rows.begin(), rows.end() - kRowsMax);
  std::string whole;
  for (const events::PastAlarm& row : rows) {
    rows_ = std::max(rows_, row.number);
    whole += line_of(row);
  }
  atomic_write(file_, whole);
  event_.rows.assign(rows.rbegin(), rows.rend());
}

void AlarmHistory::update(const std::vector<events::Alarm>& active, std::int64_t now_ms) {
  for (events::PastAlarm& row : event_.rows) {
    const auto still = [&](const events::Alarm& alarm) { return is_same(alarm, row.alarm); };
    if (!is_active(row) || std::any_of(active.begin(), active.end(), still)) continue;
    row.to_ms = static_cast<double>(now_ms);
    keep(row);
  }
  for (const events::Alarm& alarm : active) {
    const auto known = [&](const events::PastAlarm& row) {
      return is_active(row) && is_same(row.alarm, alarm);
    };
    if (std::none_of(event_.rows.begin(), event_.rows.end(), known))
      begin(alarm, static_cast<double>(now_ms), 0.0);
  }
}

void AlarmHistory::note(const events::Alarm& alarm, std::int64_t now_ms) {
  begin(alarm, static_cast<double>(now_ms), static_cast<double>(now_ms));
}

void AlarmHistory::acknowledge(std::uint32_t newest, std::int64_t now_ms) {
  for (events::PastAlarm& row : event_.rows) {
    if (!is_active(row) || row.number > newest || row.acknowledged_ms > 0.0) continue;
    row.acknowledged_ms = static_cast<double>(now_ms);
    keep(row);
  }
}

void AlarmHistory::begin(const events::Alarm& alarm, double from_ms, double to_ms) {
  const events::PastAlarm row{++rows_, alarm, from_ms, to_ms, 0.0};
  event_.rows.insert(event_.rows.begin(), row);
  if (event_.rows.size() > kRowsMax) event_.rows.pop_back();
  keep(row);
}

void AlarmHistory::keep(const events::PastAlarm& row) {
  ++version_;
  std::ofstream(file_, std::ios::app) << line_of(row);
}

}  // namespace biopsy::console
