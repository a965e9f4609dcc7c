// biopsy log: the procedure log as a table, as a CSV, and whether it is as it was written.
#include <fmt/format.h>

#include <deque>
#include <nlohmann/json.hpp>

#include "robot/cli/live_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/encoding.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/sanitize_text.hpp"
#include "robot/recorder/log_csv.hpp"
#include "robot/recorder/log_file.hpp"
#include "robot/recorder/verify.hpp"

namespace biopsy::robot {
namespace {

using recorder::Flaw;
using recorder::LogHead;
using recorder::Record;
using recorder::Verdict;

recorder::PublicKey key_for(const LogOptions& options) {
  if (!std::filesystem::exists(options.log))
    throw ConfigError("there is no such log", options.log.string(), "give the file of a procedure log");
  return recorder::read_public_key(options.public_key.empty() ? recorder::public_key_beside(options.log)
                                                              : options.public_key);
}

std::string sentence(const Verdict& verdict) {
  if (const auto* head = std::get_if<LogHead>(&verdict))
    return fmt::format(
        "The log is intact: {} records, each as it was written and in its place, and the head is signed.\n"
        "Log {}, last hash {}.\n",
        head->count, hex(head->id), hex(head->last_hash));
  return fmt::format("THE LOG IS NOT INTACT: {}.\n", plain(std::get<Flaw>(verdict).what));
}

nlohmann::json as_json(const Verdict& verdict) {
  if (const auto* head = std::get_if<LogHead>(&verdict))
    return {{"intact", true},
            {"records", head->count},
            {"log_id", hex(head->id)},
            {"last_hash", hex(head->last_hash)}};
  const Flaw& flaw = std::get<Flaw>(verdict);
  return {{"intact", false}, {"flaw", word(flaw.kind)}, {"record", flaw.record}, {"what", plain(flaw.what)}};
}

int exit_code(const Verdict& verdict) {
  return std::holds_alternative<LogHead>(verdict) ? 0 : 1;
}

void print_row(const Record& record) {
  fmt::print("{:>7}  {:.23}  {:<11}  {:<15}  {}\n", record.seq, recorder::utc_text(record.utc_ns),
             plain(record.source), plain(record.kind), plain(record.body));
}

}  // namespace

int log_show(const LogOptions& options) {
  const auto last = static_cast<std::size_t>(options.last);
  std::deque<Record> kept;
  fmt::print("{:>7}  {:<23}  {:<11}  {:<15}  {}\n", "record", "time, UTC", "from", "kind", "what");
  const Verdict verdict = recorder::verify(options.log, key_for(options), [&](const Record& record) {
    if (last == 0) return print_row(record);
    kept.push_back(record);
    if (kept.size() > last) kept.pop_front();
  });
  for (const Record& record : kept) print_row(record);
  fmt::print("\n{}", sentence(verdict));
  return exit_code(verdict);
}

int log_verify(const LogOptions& options) {
  const Verdict verdict = recorder::verify(options.log, key_for(options));
  fmt::print("{}", options.json ? as_json(verdict).dump(2) + "\n" : sentence(verdict));
  return exit_code(verdict);
}

int log_export(const LogOptions& options) {
  std::string csv(recorder::kCsvHeader);
  const Verdict verdict =
      recorder::verify(options.log, key_for(options), [&](const Record& record) { csv += csv_line(record); });
  atomic_write(options.csv, csv);
  fmt::print("{}table        {}\n", sentence(verdict), options.csv.string());
  return exit_code(verdict);
}

}  // namespace biopsy::robot
