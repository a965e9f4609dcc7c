#include "robot/recorder/log_csv.hpp"

#include <fmt/format.h>

#include <chrono>

namespace biopsy::recorder {
namespace {

std::string quoted(const std::string& text) {
  std::string field = "\"";
  for (const char letter : text) field.append(letter == '"' ? 2 : 1, letter);
  return field + '"';
}

}  // namespace

std::string csv_line(const Record& record) {
  return fmt::format("{},{},{},{},{},{},{},{:02x},{:02x}\r\n", record.seq, utc_text(record.utc_ns),
                     record.utc_ns, record.mono_us, quoted(record.source), quoted(record.kind),
                     quoted(record.body), fmt::join(record.previous, ""), fmt::join(record.hash, ""));
}

std::string utc_text(std::int64_t utc_ns) {
  using namespace std::chrono;
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t fraction_ns = (utc_ns % kSecond_ns + kSecond_ns) % kSecond_ns;
  const sys_seconds time{seconds(utc_ns / kSecond_ns - (utc_ns % kSecond_ns < 0 ? 1 : 0))};
  const auto day = floor<days>(time);
  const year_month_day date(day);
  const hh_mm_ss clock(time - day);
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02}:{:02}.{:09}", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                     clock.hours().count(), clock.minutes().count(), clock.seconds().count(), fraction_ns);
}

}  // namespace biopsy::recorder
