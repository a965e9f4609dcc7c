// A run's folder as the review page gets it: written by the report over an example that is made up, with a
// log that the recorder writes here.
#include "robot/console/review/finished_run.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "robot/common/config_error.hpp"
#include "robot/recorder/log_file.hpp"
#include "robot/recorder/recorder.hpp"
#include "robot/report/procedure/labels.hpp"
#include "robot/report/procedure/report.hpp"
#include "tests/key_files.hpp"
#include "tests/robot/report/example_run.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::console {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::int64_t kZero_us = 7'000'000'000;  // the run's beginning on the log's clock

report::RunRecord example() {
  report::RunRecord record = report::example_run();
  record.steps.at(0).image_s = 9.0;
  return record;
}

// The supervisor's changes of state, 2 ms after the run noted them, and a remark in between.
void write_log(const fs::path& folder, const report::RunRecord& record) {
  make_key_files(folder / "key.pem", recorder::public_key_beside(folder / recorder::kLogName));
  recorder::Recorder log(folder / recorder::kLogName, SigningKey(folder / "key.pem"));
  const auto append = [&](std::int64_t at_us, recorder::RecordKind kind, const std::string& body) {
    log.append({1, at_us, "supervisor", kind, body}, recorder::Urgency::Grouped, 0);
  };
  append(kZero_us - 60'000'000, recorder::RecordKind::Alarm, R"({"note":"long before"})");
  append(kZero_us - 1'000'000, recorder::RecordKind::Alarm, R"({"note":"before"})");
  for (std::size_t k = 1; k < record.samples.size(); ++k)
    if (record.samples[k].mode != record.samples[k - 1].mode)
      append(kZero_us + static_cast<std::int64_t>(1e3 * record.samples[k].time_ms) + 2'000,
             recorder::RecordKind::StateChange,
             R"({"mode":")" + std::string(report::label(record.samples[k].mode)) +
                 R"(","event":"none","reason":"none","stage":1,"stage_done":false})");
  append(kZero_us + 60'000'000, recorder::RecordKind::Alarm, R"({"note":"long after"})");
  ASSERT_TRUE(log.flush(0));
}

Json runs_of(const std::map<std::string, Document>& documents) {
  return Json::parse(*documents.at("/runs").body).at("runs");
}

TEST(FinishedRun, HasSamplesPicturesAndReport) {
  const ScratchFolder folder;
  const report::RunRecord record = example();
  report::save_report(record, folder.path());
  const auto documents = review_documents({folder.path()});
  const Json run = runs_of(documents).at(0);
  EXPECT_EQ(run.at("rows"), record.samples.size());
  EXPECT_EQ(run.at("outcome"), "completed");
  EXPECT_EQ(run.at("images").at(0).at("pictures").size(), 3U);
  EXPECT_EQ(*documents.at("/run/0/stage-1-after.png").body, file_content(folder / "stage-1-after.png"));
  EXPECT_TRUE(documents.at("/run/0/report.html").self_contained);
  const std::string& bytes = *documents.at("/run/0/samples").body;
  ASSERT_EQ(bytes.size(), 8 * record.samples.size() * run.at("columns").size());
  double last_s = 0;  // the first column is time
  std::memcpy(&last_s, bytes.data() + 8 * (record.samples.size() - 1), 8);
  EXPECT_NEAR(last_s, 1e-3 * record.samples.back().time_ms, 1e-9);
}

TEST(FinishedRun, WithoutALogSaysSo) {
  const ScratchFolder folder;
  report::save_report(example(), folder.path());
  const Json run = runs_of(review_documents({folder.path()})).at(0);
  EXPECT_TRUE(run.at("log").empty());
  EXPECT_NE(run.at("log_note").get<std::string>().find("no procedure log"), std::string::npos);
}

TEST(FinishedRun, PlacesItsLogByTheChangesOfState) {
  const ScratchFolder folder;
  const report::RunRecord record = example();
  report::save_report(record, folder.path());
  write_log(folder.path(), record);
  const Json run = runs_of(review_documents({folder.path()})).at(0);
  const std::string note = run.at("log_note");
  EXPECT_NE(note.find("is intact"), std::string::npos) << note;
  std::vector<double> spans, entries;
  for (std::size_t n = 1; n < run.at("spans").size(); ++n)
    if (run["spans"][n]["mode"] != run["spans"][n - 1]["mode"]) spans.push_back(run["spans"][n]["from"]);
  for (const Json& entry : run.at("log"))
    if (entry.at("kind") == "state change") entries.push_back(entry.at("at"));
  ASSERT_EQ(entries.size(), spans.size());
  for (std::size_t n = 0; n < spans.size(); ++n) EXPECT_NEAR(entries[n], spans[n], 0.002);
  EXPECT_EQ(run["log"][0]["text"], "before") << "ten seconds around the run, no more";
  EXPECT_EQ(run["log"].back()["kind"], "state change");
}

TEST(FinishedRun, OfAConsoleFindsTheLogOfItsRobot) {
  const ScratchFolder robot;
  const fs::path folder = robot / "console/20261125T101010/run-1";
  fs::create_directories(folder);
  const report::RunRecord record = example();
  report::save_report(record, folder);
  write_log(robot.path(), record);
  EXPECT_GT(runs_of(review_documents({folder})).at(0).at("log").size(), 3U);
}

TEST(FinishedRun, ShowsALogThatWasAlteredAndSaysThatItWas) {
  const ScratchFolder folder;
  const report::RunRecord record = example();
  report::save_report(record, folder.path());
  write_log(folder.path(), record);
  make_key_files(folder / "other.pem", recorder::public_key_beside(folder / recorder::kLogName));
  const Json run = runs_of(review_documents({folder.path()})).at(0);
  EXPECT_NE(run.at("log_note").get<std::string>().find("NOT INTACT"), std::string::npos);
  EXPECT_GT(run.at("log").size(), 3U);
}

TEST(FinishedRun, WithALogThatIsNoneIsShownWithoutIt) {
  const ScratchFolder folder;
  report::save_report(example(), folder.path());
  folder.write(recorder::kLogName, "not a database");
  const Json run = runs_of(review_documents({folder.path()})).at(0);
  EXPECT_TRUE(run.at("log").empty());
  EXPECT_GT(run.at("spans").size(), 3U);
}

TEST(FinishedRun, LeavesTheFolderAsItWas) {
  const ScratchFolder folder;
  const report::RunRecord record = example();
  report::save_report(record, folder.path());
  write_log(folder.path(), record);
  const auto state = [&] {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder.path()))
      if (entry.is_regular_file()) files[entry.path()] = file_content(entry.path());
    return files;
  };
  const auto before = state();
  review_documents({folder.path(), folder.path()});
  EXPECT_EQ(state(), before);
}

// A device in its place may never end.
TEST(FinishedRun, ReadsFilesOnly) {
  const ScratchFolder folder;
  report::save_report(example(), folder.path());
  for (const char* name : {"report.json", "run.csv"}) {
    const fs::path file = folder / name;
    fs::rename(file, folder / "kept");
    fs::create_symlink("/dev/null", file);
    try {
      review_documents({folder.path()});
      ADD_FAILURE() << name;
    } catch (const ConfigError& refusal) {
      EXPECT_EQ(refusal.what_is_wrong, "is not a file");
    }
    fs::rename(folder / "kept", file);
  }
}

TEST(FinishedRun, OfABadFolderSaysWhatIsWrong) {
  const ScratchFolder folder;
  EXPECT_THROW(review_documents({folder / "nothing"}), ConfigError);
  EXPECT_THROW(review_documents({folder.path()}), ConfigError) << "an empty folder";
  report::save_report(example(), folder.path());
  EXPECT_NO_THROW(review_documents({folder.path()}));
  folder.write("stage-1-after.png", "<svg/>");
  EXPECT_THROW(review_documents({folder.path()}), ConfigError) << "no PNG";
  fs::remove(folder / "stage-1-after.png");
  fs::remove(folder / "run.csv");
  EXPECT_THROW(review_documents({folder.path()}), ConfigError) << "a run that never began";
}

}  // namespace
}  // namespace biopsy::console
