#include "robot/console/review/run_log.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "robot/common/config_error.hpp"
#include "robot/common/text/number_text.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/common/text/text_layout.hpp"
#include "robot/recorder/log_alignment.hpp"
#include "robot/recorder/log_file.hpp"
#include "robot/recorder/record_text.hpp"
#include "robot/recorder/verify.hpp"

namespace biopsy::console {
namespace {

namespace fs = std::filesystem;
using recorder::Record;

constexpr std::size_t kRecordsMax = 100'000, kText = 290, kSource = 60, kKind = 30;
constexpr std::int64_t kAround_us = 10'000'000;

std::optional<fs::path> log_of(const fs::path& folder) {
  const fs::path console = folder.parent_path().parent_path();
  for (const fs::path& place : {folder, console.filename() == "console" ? console.parent_path() : folder})
    if (fs::is_regular_file(place / recorder::kLogName)) return place / recorder::kLogName;
  return std::nullopt;
}

struct Records {
  std::string verdict;  // a sentence
  std::vector<Record> all;
};

Records read_records(const fs::path& log) {
  const fs::path key = recorder::public_key_beside(log);
  const bool has_key = fs::is_regular_file(key);
  Records read;
  const recorder::Verdict verdict =
      recorder::verify(log, has_key ? read_public_key(key) : PublicKey{}, [&](const Record& record) {
        if (!read.all.empty() && record.seq <= read.all.back().seq) read.all.clear();  // read once more
        if (read.all.size() < kRecordsMax) read.all.push_back(record);
      });
  if (const auto* head = std::get_if<recorder::LogHead>(&verdict))
    read.verdict = fmt::format("The log is intact by the key beside it: {}", counted(head->count, "record"));
  else if (!has_key)
    read.verdict = "Nobody knows whether the log is intact: its public key is not beside it";
  else
    read.verdict = "THE LOG IS NOT INTACT: " + plain(std::get<recorder::Flaw>(verdict).what);
  return read;
}

std::vector<recorder::ModeChange> changes_of(const std::vector<review::Span>& spans) {
  std::vector<recorder::ModeChange> changes;
  for (std::size_t i = 1; i < spans.size(); ++i)
    if (spans[i].mode != spans[i - 1].mode)
      changes.push_back({static_cast<std::int64_t>(1e6 * spans[i].from), spans[i].mode});
  return changes;
}

}  // namespace

RunLog read_run_log(const fs::path& folder, const std::vector<review::Span>& spans, double end_s) {
  const std::optional<fs::path> file = log_of(folder);
  if (!file) return {"This run has no procedure log: only runs with the real processes write one.", {}};
  RunLog log;
  try {
    const Records read = read_records(*file);
    const auto place = recorder::align(changes_of(spans), recorder::mode_changes(read.all));
    if (!place) {
      log.note =
          read.verdict + ". Fewer than two changes of state agree with the run: it cannot be placed in time.";
      return log;
    }
    log.note = fmt::format("{}. Placed by {}, which agree within {:.0f} ms.", read.verdict,
                           counted(place->matched, "change") + " of state",
                           1e-3 * static_cast<double>(place->spread_us));
    const auto until_us = static_cast<std::int64_t>(1e6 * end_s) + kAround_us;
    recorder::SignedIn signed_in;
    for (const Record& record : read.all) {
      signed_in.follow(record);
      const std::int64_t at_us = record.mono_us - place->zero_us;
      if (at_us < -kAround_us || at_us > until_us) continue;
      log.entries.push_back({1e-6 * static_cast<double>(at_us), shortened(plain(record.source), kSource),
                             shortened(plain(record.kind), kKind),
                             shortened(plain(recorder::text_of(record, signed_in.name())), kText)});
    }
    std::stable_sort(log.entries.begin(), log.entries.end(),
                     [](const review::LogEntry& a, const review::LogEntry& b) { return a.at < b.at; });
  } catch (const ConfigError& refusal) {
    log.note = "The log cannot be read: " + plain(refusal.what_is_wrong) + ".";
  }
  log.note = shortened(log.note, kText);
  return log;
}

}  // namespace biopsy::console
