// The log as MCAP, read by @mcap/core, which shares no code with the writer. Records and run are drawn here,
// seeded: every kind of record, texts of all kinds, several chunks, clocks that are not in order.
#include "robot/recorder/log_mcap.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "robot/common/config_error.hpp"
#include "robot/recorder/log_csv.hpp"
#include "robot/report/procedure/report.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::recorder {
namespace {

constexpr std::int64_t kBegin_ns = 1'795'285'292'123'456'789;
const std::vector<std::string> kModes{"boot", "safe", "ready", "armed", "active", "hold", "retract", "safe"};

Record record_of(std::uint64_t seq, std::int64_t at_ns, const std::string& kind, std::string body) {
  Record record;
  record.seq = seq;
  record.utc_ns = kBegin_ns + at_ns;
  record.mono_us = at_ns / 1000 + 17;
  record.source = "supervisor";
  record.kind = kind;
  record.body = std::move(body);
  for (std::size_t i = 0; i < record.hash.size(); ++i)
    record.hash[i] = static_cast<std::uint8_t>(seq * 31 + i),
    record.previous[i] = static_cast<std::uint8_t>(seq + i);
  return record;
}

// A second between two changes of mode; other records between them.
std::vector<Record> drawn_log(std::size_t between) {
  std::mt19937 random(9);
  const std::vector<std::string> texts{"plain",
                                       "comma, \"quote\"\nand line",
                                       "µ, Ω, 日本",
                                       R"({"a":1.5,"b":"x"})",
                                       R"({"a":"now a text","c":[1,2],"d":{"e":null}})",
                                       "[1,2]",
                                       "{broken",
                                       ""};
  std::vector<Record> records;
  for (std::size_t change = 0; change < kModes.size(); ++change) {
    const auto second_ns = static_cast<std::int64_t>(change) * 1'000'000'000;
    for (std::size_t n = 0; n < between; ++n) {
      const auto kind = static_cast<RecordKind>(random() % kRecordKinds);
      if (kind == RecordKind::StateChange) continue;
      const auto at_ns = second_ns + static_cast<std::int64_t>(random() % 2'000'000'000);
      records.push_back(record_of(records.size() + 1, at_ns, name_of(kind),
                                  texts[random() % texts.size()] + std::string(random() % 3 * 100, ' ')));
    }
    records.push_back(record_of(records.size() + 1, second_ns, name_of(RecordKind::StateChange),
                                fmt::format(R"({{"mode":"{}","stage":1}})", kModes[change])));
  }
  return records;
}

// From a second before the robot is ready.
std::string drawn_run() {
  std::string csv = "time_s,displacement_mm,monitor_kV,mode,stop,stage,gate\n";
  for (int ms = 0; ms < 5'000; ++ms)
    csv += fmt::format("{:.3f},{:.5f},{:.6f},{},none,1,granted\n", ms * 1e-3, ms * 3e-4, ms * 1e-6 - 0.1,
                       kModes[static_cast<std::size_t>(1 + ms / 1000)]);
  return csv;
}

TEST(McapCore, ReadsEveryMessageAsItIsInTheLog) {
  const std::filesystem::path reader = binary_dir() / "mcap_reader";
  if (!std::filesystem::exists(reader / "node_modules")) GTEST_SKIP() << "without npm and its registry";
  const ScratchFolder folder;
  for (const std::size_t between : {0U, 3U, 2'000U}) {
    const std::vector<Record> records = drawn_log(between);
    std::string csv(kCsvHeader);
    for (const Record& record : records) csv += csv_line(record);
    folder.write("log.csv", csv);
    folder.write("run.csv", drawn_run());
    const CsvTable run = read_csv(folder / "run.csv");
    const std::string file = log_mcap(records, &run, "test");
    folder.write("log.mcap", file);
    EXPECT_TRUE(between < 2'000 || file.size() > 3'000'000) << "one chunk only";
    const std::string command = fmt::format("cd {} && node compare.mjs {} {} {} > {} 2>&1", reader.string(),
                                            (folder / "log.mcap").string(), (folder / "log.csv").string(),
                                            (folder / "run.csv").string(), (folder / "told").string());
    EXPECT_EQ(std::system(command.c_str()), 0) << file_content(folder / "told");
    EXPECT_NE(file_content(folder / "told").find(fmt::format("{} messages", records.size() + 5'000)),
              std::string::npos)
        << file_content(folder / "told");
    // And the reader sees what is changed: a digit of a body, and the CRC of its chunk with it.
    std::string changed = file;
    changed[changed.find("\"stage\\\":1")] = '!';
    folder.write("log.mcap", changed);
    EXPECT_NE(std::system(command.c_str()), 0);
  }
}

// The columns are those of a simulated run, the bodies as the recorder writes them. Mcap.RecordsLiveRuns asks
// the same of a real log.
TEST(McapCore, FindsEveryPathOfTheExamplesLayout) {
  const std::filesystem::path reader = binary_dir() / "mcap_reader";
  if (!std::filesystem::exists(reader / "node_modules")) GTEST_SKIP() << "without npm and its registry";
  std::vector<Record> records = drawn_log(0);
  records.push_back(
      record_of(records.size() + 1, 9'000'000'000, name_of(RecordKind::Plan), R"({"seal_holds":true})"));
  report::RunRecord run;
  for (std::size_t ms = 0; ms < 3'000; ++ms)
    run.samples.push_back({.time_ms = static_cast<double>(ms),
                           .mode = std::array{Mode::Safe, Mode::Ready, Mode::Armed}[ms / 1'000]});
  const ScratchFolder folder;
  folder.write("run.csv", report::run_csv(run));
  const CsvTable rows = read_csv(folder / "run.csv");
  folder.write("log.mcap", log_mcap(records, &rows, "test"));
  const std::string command = fmt::format("cd {} && node paths.mjs {} {} > {} 2>&1", reader.string(),
                                          (source_dir() / "docs/examples/foxglove-layout.json").string(),
                                          (folder / "log.mcap").string(), (folder / "told").string());
  EXPECT_EQ(std::system(command.c_str()), 0) << file_content(folder / "told");
}

TEST(LogMcap, PutsTheRunWhereTheLogWentThroughItsStates) {
  const std::vector<Record> records = drawn_log(0);
  const ScratchFolder folder;
  folder.write("run.csv", drawn_run());
  const CsvTable run = read_csv(folder / "run.csv");
  const std::string file = log_mcap(records, &run, "test");
  // Its first row is a second before "ready", which is two seconds after the log's beginning.
  std::string time;
  for (int n = 0; n < 8; ++n)
    time += static_cast<char>(static_cast<std::uint64_t>(kBegin_ns + 1'000'000'000) >> (8 * n));
  const std::size_t row = file.find("{\"time_s\":0.0");
  ASSERT_NE(row, std::string::npos);
  EXPECT_EQ(file.substr(row - 16, 8), time);
}

TEST(LogMcap, RefusesARunOfAnotherLog) {
  const ScratchFolder folder;
  const auto refused = [&](const std::string& csv) {
    folder.write("run.csv", csv);
    const CsvTable run = read_csv(folder / "run.csv");
    EXPECT_THROW(log_mcap(drawn_log(0), &run, "test"), ConfigError) << csv;
  };
  refused("time_s,mode\n0,safe\n1,armed\n");   // was ready between
  refused("time_s,mode\n0,ready\n1,ready\n");  // no change: nobody knows when
  refused("time_s,depth\n0,1\n1,2\n");
  refused("time_s,mode\n0,safe\nx,ready\n");
}

TEST(LogMcap, AnEmptyLogIsAWholeFile) {
  const std::string file = log_mcap({}, nullptr, "test");
  EXPECT_TRUE(file.starts_with("\x89MCAP0\r\n"));
  EXPECT_TRUE(file.ends_with("\x89MCAP0\r\n"));
}

}  // namespace
}  // namespace biopsy::recorder
