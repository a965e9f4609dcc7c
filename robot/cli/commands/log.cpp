// biopsy log: the procedure log as a table, as a CSV, and whether it is as it was written.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "robot/cli/command.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/ed25519.hpp"
#include "robot/common/files/csv_table.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/text/encoding.hpp"
#include "robot/common/text/number_text.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/recorder/log_csv.hpp"
#include "robot/recorder/log_file.hpp"
#include "robot/recorder/log_mcap.hpp"
#include "robot/recorder/record_text.hpp"
#include "robot/recorder/verify.hpp"

namespace biopsy::robot {
namespace log_cli {

using recorder::Flaw;
using recorder::LogHead;
using recorder::Record;
using recorder::Verdict;

struct Options {
  std::filesystem::path log;             // the SQLite file
  std::filesystem::path public_key;      // empty: the one beside the log
  std::filesystem::path csv, mcap, run;  // export only
  // show only
  int last = 0;  // this many records from the end; 0: all
  std::vector<std::string> kinds, sources;
  std::string since, until;
  bool raw = false;
};

void declare(CLI::App& app, Options& options) {
  add(app, "LOG", options.log, "the log's file (SQLite); may be in use")->required();
  add(app, "--public-key PEM", options.public_key, "Ed25519 key that its head is signed with",
      "`LOG.pub.pem`, the one beside the log");
}

void declare_show(CLI::App& app, Options& options) {
  declare(app, options);
  add(app, "--last N", options.last, "only this many records, from the end; 0: all", "0")
      ->check(in_range(0, 1'000'000'000));
  add(app, "--kind KIND", options.kinds, "only records of this kind, as the table names it; may be repeated",
      "all");
  add(app, "--source SOURCE", options.sources,
      "only records from this process, as the table names it; may be repeated", "all");
  add(app, "--since UTC", options.since, "only from this time on, like \"2026-11-25 08:45:11\"",
      "the beginning");
  add(app, "--until UTC", options.until, "only up to this time", "the end");
  app.add_flag("--raw", options.raw, "bodies as they are stored, in JSON, instead of words");
}

void declare_export(CLI::App& app, Options& options) {
  declare(app, options);
  add(app, "--csv FILE", options.csv, "write a CSV table; whole or not at all", "none");
  CLI::Option* mcap =
      add(app, "--mcap FILE", options.mcap,
          "write an [MCAP](https://mcap.dev) file, for viewers such as Foxglove or PlotJuggler", "none");
  add(app, "--run FILE", options.run, "a run.csv of this log, as the topic `/run` of the MCAP file", "none")
      ->needs(mcap);
}

PublicKey key_for(const Options& options) {
  if (!std::filesystem::exists(options.log))
    throw ConfigError("there is no such log", options.log.string(), "give the file of a procedure log");
  return read_public_key(
      options.public_key.empty() ? recorder::public_key_beside(options.log) : options.public_key,
      "name the public key of the recorder that wrote the log, with --public-key");
}

std::string sentence(const Verdict& verdict) {
  if (const auto* head = std::get_if<LogHead>(&verdict))
    return fmt::format(
        "The log is intact: {}, each as it was written and in its place, and the head is signed.\n"
        "Log {}, last hash {}.\n",
        counted(head->count, "record"), hex(head->id), hex(head->last_hash));
  return fmt::format("THE LOG IS NOT INTACT: {}.\n", plain(std::get<Flaw>(verdict).what));
}

nlohmann::ordered_json as_json(const Verdict& verdict) {
  if (const auto* head = std::get_if<LogHead>(&verdict))
    return {{"intact", true},
            {"records", head->count},
            {"log_id", hex(head->id)},
            {"last_hash", hex(head->last_hash)}};
  const Flaw& flaw = std::get<Flaw>(verdict);
  return {
      {"intact", false}, {"flaw", name_of(flaw.kind)}, {"record", flaw.record}, {"what", plain(flaw.what)}};
}

int exit_code(const Verdict& verdict) {
  return std::holds_alternative<LogHead>(verdict) ? 0 : 1;
}

struct Row {
  Record record;
  std::string signed_in;
};

std::string row_text(const Row& row, bool raw) {
  const Record& record = row.record;
  return fmt::format("{:>7}  {:.23}  {:<11}  {:<15}  {}\n", record.seq, recorder::utc_text(record.utc_ns),
                     plain(record.source), plain(record.kind),
                     plain(raw ? record.body : recorder::text_of(record, row.signed_in)));
}

nlohmann::ordered_json record_json(const Row& row) {
  const Record& record = row.record;
  return {{"record", record.seq},           {"time_utc", recorder::utc_text(record.utc_ns)},
          {"source", plain(record.source)}, {"kind", plain(record.kind)},
          {"body", plain(record.body)},     {"text", plain(recorder::text_of(record, row.signed_in))}};
}

std::string dumped(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

// "2026-11-25 08:45:11", with fewer or more digits: as the beginning of the time that the table shows.
std::string time_prefix(const std::string& text, const char* option) {
  static const std::regex kTime(R"(\d{4}-\d{2}-\d{2}([ T]\d{2}(:\d{2}(:\d{2}(\.\d{1,9})?)?)?)?)");
  if (text.empty()) return text;
  const auto part = [&](std::size_t from, std::size_t count) {
    return text.size() < from + count ? 0U : static_cast<unsigned>(std::stoul(text.substr(from, count)));
  };
  if (std::regex_match(text, kTime)) {
    const std::chrono::year_month_day day{std::chrono::year(static_cast<int>(part(0, 4))),
                                          std::chrono::month(part(5, 2)), std::chrono::day(part(8, 2))};
    const bool exists =
        day.ok() && part(11, 2) < 24 && part(14, 2) < 60 && part(17, 2) <= 60;  // leap seconds
    if (exists) return std::regex_replace(text, std::regex("T"), " ");
  }
  throw ConfigError(fmt::format("\"{}\" is not a time", text), option,
                    "give UTC like \"2026-11-25 08:45:11\", or a part of it");
}

// Which records are asked for. Refuses a kind that no record has, and a time that ends before it begins.
class Selection {
 public:
  explicit Selection(const Options& options)
      : kinds_(options.kinds.begin(), options.kinds.end()),
        sources_(options.sources.begin(), options.sources.end()),
        since_(time_prefix(options.since, "--since")),
        until_(time_prefix(options.until, "--until")) {
    std::vector<std::string> known;
    for (std::size_t i = 0; i < recorder::kRecordKinds; ++i)
      known.emplace_back(name_of(static_cast<recorder::RecordKind>(i)));
    for (const std::string& kind : kinds_)
      if (std::ranges::find(known, kind) == known.end())
        throw ConfigError(fmt::format("no record is of the kind \"{}\"", kind), "--kind",
                          fmt::format("one of: {}", fmt::join(known, ", ")));
    if (!until_.empty() && until_ < since_.substr(0, until_.size()))
      throw ConfigError(fmt::format("\"{}\" lies before \"{}\"", until_, since_), "--until",
                        "give a time after that of --since");
  }

  bool has(const Record& record) {
    seen_.insert(record.source);
    const std::string time = recorder::utc_text(record.utc_ns);
    return (kinds_.empty() || kinds_.contains(record.kind)) &&
           (sources_.empty() || sources_.contains(record.source)) && time >= since_ &&
           (until_.empty() || time.substr(0, until_.size()) <= until_);
  }

  // After the last record: a source that is misspelt must not look like one that wrote nothing.
  void refuse_unknown_sources() const {
    for (const std::string& source : sources_)
      if (!seen_.contains(source))
        throw ConfigError(fmt::format("no record is from \"{}\"", source), "--source",
                          fmt::format("one of: {}", plain(fmt::format("{}", fmt::join(seen_, ", ")))));
  }

 private:
  std::set<std::string> kinds_, sources_, seen_;
  std::string since_, until_;
};

Result show(const Options& options, const Context&) {
  Selection selection(options);
  const auto last = static_cast<std::size_t>(options.last);
  std::deque<Row> kept;
  recorder::SignedIn signed_in;
  const Verdict verdict = recorder::verify(options.log, key_for(options), [&](const Record& record) {
    signed_in.follow(record);
    if (!selection.has(record)) return;
    kept.push_back({record, signed_in.name()});
    if (last != 0 && kept.size() > last) kept.pop_front();
  });
  if (std::holds_alternative<LogHead>(verdict)) selection.refuse_unknown_sources();
  std::string text =
      fmt::format("{:>7}  {:<23}  {:<11}  {:<15}  {}\n", "record", "time, UTC", "from", "kind", "what");
  nlohmann::ordered_json records = nlohmann::ordered_json::array();
  for (const Row& row : kept) {
    text += row_text(row, options.raw);
    records.push_back(record_json(row));
  }
  return {.exit_code = exit_code(verdict),
          .text = text + "\n" + sentence(verdict),
          .json = dumped({{"records", records}, {"verdict", as_json(verdict)}})};
}

Result verify(const Options& options, const Context&) {
  const Verdict verdict = recorder::verify(options.log, key_for(options));
  return {.exit_code = exit_code(verdict), .text = sentence(verdict), .json = dumped(as_json(verdict))};
}

Result export_log(const Options& options, const Context&) {
  if (options.csv.empty() && options.mcap.empty())
    throw ConfigError("neither --csv nor --mcap", "log export",
                      "say what to write: --csv FILE, --mcap FILE or both");
  std::vector<Record> records;
  const Verdict verdict = recorder::verify(options.log, key_for(options),
                                           [&](const Record& record) { records.push_back(record); });
  Result result{.exit_code = exit_code(verdict), .text = sentence(verdict)};
  nlohmann::ordered_json json;
  const auto write = [&](const char* name, const std::filesystem::path& file, const std::string& content) {
    atomic_write(file, content);
    result.text += fmt::format("{:<13}{}\n", name, file.string());
    json[name] = file.string();
  };
  if (!options.csv.empty()) {
    std::string csv(recorder::kCsvHeader);
    for (const Record& record : records) csv += csv_line(record);
    write("csv", options.csv, csv);
  }
  if (!options.mcap.empty()) {
    std::optional<CsvTable> run;
    if (!options.run.empty()) run = read_csv(options.run);
    write("mcap", options.mcap, recorder::log_mcap(records, run ? &*run : nullptr, "biopsy " BIOPSY_VERSION));
  }
  json["verdict"] = as_json(verdict);
  result.json = dumped(json);
  return result;
}

constexpr const char* kExitCodes = "0 where the log is intact, 1 where it is not, 2 for unusable input";
constexpr const char* kVerdict =
    "`intact`, `records`, `log_id`, `last_hash`; or `intact`, `flaw`, `record`, `what`";

}  // namespace log_cli

Command log_group() {
  using namespace log_cli;
  return {.name = "log",
          .summary = "the procedure log: show, verify, export",
          .description = "All three read the whole [procedure log](procedure-log.md) and verify it."};
}

Command log_show_command() {
  using namespace log_cli;
  return {
      .name = "log show",
      .summary = "print the records as a table",
      .long_examples = {"biopsy log show out/live/procedure.log.sqlite --last 20",
                        "biopsy log show out/live/procedure.log.sqlite --kind 'state change' --kind alarm"},
      .exit_codes = kExitCodes,
      .json =
          "`records`: list of `record`, `time_utc`, `source`, `kind`, `body`, and `text`, the body in words; "
          "`verdict`: as `log verify --json`",
      .declare = with_options(declare_show, show)};
}

Command log_verify_command() {
  using namespace log_cli;
  return {.name = "log verify",
          .summary = "whether it is whole and unchanged",
          .long_examples = {"biopsy log verify out/live/procedure.log.sqlite"},
          .exit_codes = kExitCodes,
          .json = kVerdict,
          .declare = with_options(declare, verify)};
}

Command log_export_command() {
  using namespace log_cli;
  return {.name = "log export",
          .summary = "write it as a CSV table or as MCAP",
          .long_examples = {"biopsy log export out/live/procedure.log.sqlite --csv out/log.csv",
                            "biopsy log export out/live/procedure.log.sqlite --mcap out/log.mcap --run "
                            "out/live/run.csv"},
          .exit_codes = kExitCodes,
          .json = "`csv`, `mcap`: the files that were asked for; `verdict`: as `log verify --json`",
          .declare = with_options(declare_export, export_log)};
}

}  // namespace biopsy::robot
