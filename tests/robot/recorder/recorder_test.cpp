// When records are written, and failures of writing, in virtual time.
#include "robot/recorder/recorder.hpp"

#include <random>

#include "robot/common/config_error.hpp"
#include "tests/robot/recorder/log_for_tests.hpp"

namespace biopsy::recorder {
namespace {

TEST(Recorder, GroupedRecordsWaitInMemoryAndAreOnDiskWithin100Ms) {
  const LogFolder folder;
  Recorder recorder(folder.log, folder.key());
  recorder.append(entry(1), Urgency::Grouped, 5 * kMs);
  recorder.append(entry(2), Urgency::Grouped, 60 * kMs);
  std::int64_t written_us = 0;
  for (std::int64_t now = 5 * kMs; now < 200 * kMs && written_us == 0; now += 10 * kMs) {
    recorder.poll(now);
    if (recorder.written().count == 2) written_us = now;
  }
  EXPECT_GE(written_us, 5 * kMs + kGroup_us) << "one group, not one transaction a record";
  EXPECT_LE(written_us, 5 * kMs + 100 * kMs);
  EXPECT_EQ(count_of(folder.verdict()), 2U) << "a reader sees them while the recorder runs";
}

TEST(Recorder, AnUrgentRecordIsWrittenAtOnceWithAllBeforeIt) {
  const LogFolder folder;
  Recorder recorder(folder.log, folder.key());
  recorder.append(entry(1), Urgency::Grouped, 0);
  recorder.append(entry(2), Urgency::Grouped, 0);
  EXPECT_EQ(recorder.written().count, 0U);
  recorder.append(entry(3), Urgency::Urgent, 1);
  EXPECT_EQ(recorder.written().count, 3U);
  EXPECT_EQ(recorder.backlog_ms(10'000 * kMs), 0);
  const auto records = records_of(folder.log, folder.public_key());
  ASSERT_EQ(records.size(), 3U);
  for (std::int64_t n = 1; n <= 3; ++n) EXPECT_EQ(records[n - 1].body, entry(n).body);
}

TEST(Recorder, BacklogIsTheAgeOfTheOldestUnwrittenRecord) {
  const LogFolder folder;
  Recorder recorder(folder.log, folder.key());
  EXPECT_EQ(recorder.backlog_ms(5 * kMs), 0);
  recorder.append(entry(1), Urgency::Grouped, 10 * kMs);
  recorder.append(entry(2), Urgency::Grouped, 40 * kMs);
  EXPECT_EQ(recorder.backlog_ms(70 * kMs), 60);
  EXPECT_TRUE(recorder.flush(70 * kMs));
  EXPECT_EQ(recorder.backlog_ms(90 * kMs), 0);
}

TEST(Recorder, WritesWhatItWasGivenByteByByte) {
  const LogFolder folder;
  std::mt19937 random(1);
  std::vector<Entry> given;
  {
    Recorder recorder(folder.log, folder.key());
    for (int n = 0; n < 200; ++n) {
      Entry one = entry(n, " ");
      one.utc_ns = static_cast<std::int64_t>(random()) << 31U ^ -n;
      one.mono_us = -static_cast<std::int64_t>(random());
      one.body.assign(random() % 400, '\0');
      for (char& letter : one.body) letter = static_cast<char>(random());
      given.push_back(one);
      recorder.append(one, n % 7 ? Urgency::Grouped : Urgency::Urgent, n * kMs);
    }
    ASSERT_TRUE(recorder.flush(0));
  }
  ASSERT_TRUE(is_intact(folder.verdict())) << text_of(folder.verdict());
  const auto read = records_of(folder.log, folder.public_key());
  ASSERT_EQ(read.size(), given.size());
  for (std::size_t n = 0; n < read.size(); ++n) {
    EXPECT_EQ(read[n].seq, n + 1);
    EXPECT_EQ(read[n].utc_ns, given[n].utc_ns);
    EXPECT_EQ(read[n].mono_us, given[n].mono_us);
    EXPECT_EQ(read[n].source, given[n].source);
    EXPECT_EQ(read[n].kind, name_of(given[n].kind));
    EXPECT_EQ(read[n].body, given[n].body);
  }
}

TEST(Recorder, ContinuesTheChainOfALogThatVerifies) {
  const LogFolder folder(5);
  const auto before = std::get<LogHead>(folder.verdict());
  folder.write(folder.log, 3);
  const auto after = std::get<LogHead>(folder.verdict());
  EXPECT_EQ(after.id, before.id);
  EXPECT_EQ(after.count, 8U);
  EXPECT_EQ(records_of(folder.log, folder.public_key())[5].previous, before.last_hash);
}

TEST(Recorder, AddsNothingToALogThatDoesNotVerifyAndLeavesItAsItIs) {
  const LogFolder folder(20);
  tamper(folder.log, "UPDATE record SET body = 'nothing happened' WHERE seq = 7");
  const std::string before = file_content(folder.log);
  try {
    Recorder recorder(folder.log, folder.key());
    FAIL() << "an altered log was opened";
  } catch (const ConfigError& error) {
    EXPECT_NE(error.what_is_wrong.find("record 7"), std::string::npos) << error.what();
    EXPECT_NE(error.remedy.find("move it aside"), std::string::npos);
  }
  EXPECT_EQ(file_content(folder.log), before);
}

TEST(Recorder, RefusesALogOfAnotherKeyAnEmptyFileAndAFolder) {
  const LogFolder folder(2);
  make_key_files(folder.scratch / "other.pem");
  EXPECT_THROW(Recorder(folder.log, SigningKey(folder.scratch / "other.pem")), ConfigError);
  folder.scratch.write("empty.log", "");
  EXPECT_THROW(Recorder(folder.scratch / "empty.log", folder.key()), ConfigError);
  EXPECT_THROW(Recorder(folder.scratch.path(), folder.key()), ConfigError);
  EXPECT_THROW(Recorder("/proc/nowhere/procedure.log", folder.key()), ConfigError);
  fs::rename(folder.log, folder.scratch / "kept.log");
  folder.scratch.write("procedure.log-wal", "the end of another log");
  EXPECT_THROW(Recorder(folder.log, folder.key()), ConfigError)
      << "a new log would swallow the old one's WAL";
  EXPECT_FALSE(fs::exists(folder.log));
}

TEST(Recorder, ASecondRecorderOfOneLogIsRefused) {
  const LogFolder folder;
  {
    Recorder first(folder.log, folder.key());
    EXPECT_THROW(Recorder(folder.log, folder.key()), ConfigError);
    first.append(entry(1), Urgency::Urgent, 0);
    EXPECT_EQ(first.written().count, 1U);
  }
  EXPECT_NO_THROW(Recorder(folder.log, folder.key()));
}

TEST(Recorder, NeverMixesTwoChainsWhereAnotherProgramWrites) {
  const LogFolder folder(2);
  Recorder recorder(folder.log, folder.key());
  tamper(folder.log, "UPDATE head SET count = 1");
  recorder.append(entry(3), Urgency::Urgent, 0);
  EXPECT_EQ(recorder.last_error(), "another program wrote to the log");
  EXPECT_EQ(recorder.backlog_ms(1500 * kMs), 1500) << "the supervisor will stop the procedure";
  tamper(folder.log, "UPDATE head SET count = 2");
  recorder.poll(1500 * kMs);
  EXPECT_EQ(recorder.backlog_ms(1500 * kMs), 0);
  EXPECT_EQ(count_of(folder.verdict()), 3U);
}

TEST(Recorder, AFileThatWasMovedAwayIsABacklogAndNotASilentLoss) {
  const LogFolder folder;
  Recorder recorder(folder.log, folder.key());
  fs::rename(folder.log, folder.scratch / "moved.log");
  recorder.append(entry(1), Urgency::Urgent, 0);
  EXPECT_EQ(recorder.written().count, 0U);
  EXPECT_EQ(recorder.last_error(), "the log's file was moved or deleted");
  EXPECT_FALSE(recorder.flush(0));
  fs::rename(folder.scratch / "moved.log", folder.log);
  recorder.poll(kRetry_us - 1);
  EXPECT_EQ(recorder.written().count, 0U) << "not before the retry time";
  recorder.poll(kRetry_us);
  EXPECT_EQ(recorder.written().count, 1U);
  EXPECT_TRUE(recorder.last_error().empty());
}

TEST(Recorder, LaysThePublicKeyBesideTheLogAndLeavesNoTemporaryFile) {
  const LogFolder folder(1);
  EXPECT_EQ(read_public_key(public_key_beside(folder.log)), folder.public_key());
  for (const auto& file : fs::directory_iterator(folder.scratch.path()))
    EXPECT_EQ(file.path().string().find(".part"), std::string::npos) << file.path();
}

}  // namespace
}  // namespace biopsy::recorder
