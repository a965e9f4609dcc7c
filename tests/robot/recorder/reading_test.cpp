// Reading a log writes nothing, whatever state its files are in.
#include <sys/wait.h>
#include <unistd.h>

#include <map>
#include <random>

#include "tests/robot/recorder/log_for_tests.hpp"

namespace biopsy::recorder {
namespace {

using Snapshot = std::map<std::string, std::pair<std::string, fs::file_time_type>>;

Snapshot snapshot(const fs::path& folder) {
  Snapshot files;
  for (const auto& file : fs::directory_iterator(folder))
    files[file.path().filename()] = {file_content(file.path()), file.last_write_time()};
  return files;
}

// A recorder that ends without closing anything, as by kill -9.
void write_and_die(const LogFolder& folder, std::int64_t records) {
  const pid_t child = ::fork();
  if (child == 0) {
    Recorder recorder(folder.log, folder.key());
    for (std::int64_t n = 1; n <= records; ++n) recorder.append(entry(n), Urgency::Urgent, n);
    ::_exit(recorder.written().count == static_cast<std::uint64_t>(records) ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_EQ(status, 0);
}

void expect_read_untouched(const fs::path& folder, const fs::path& log, const PublicKey& key,
                           std::uint64_t records) {
  const Snapshot before = snapshot(folder);
  const Verdict verdict = verify(log, key);
  EXPECT_EQ(text_of(verdict), "intact");
  EXPECT_EQ(count_of(verdict), records);
  EXPECT_TRUE(snapshot(folder) == before);
}

TEST(Reading, ALiveLogIsReadAsOfItsLastCommitAndDoesNotHinderTheRecorder) {
  const LogFolder folder;
  Recorder recorder(folder.log, folder.key());
  for (std::uint64_t n = 0; n < 30; ++n) {
    EXPECT_EQ(count_of(folder.verdict()), n);
    recorder.append(entry(1), Urgency::Grouped, 0);
    EXPECT_EQ(count_of(folder.verdict()), n) << "not yet committed";
    ASSERT_TRUE(recorder.flush(0)) << recorder.last_error();
  }
}

TEST(Reading, AKilledRecordersLogIsReadWithItsWalAndLeftAlone) {
  const LogFolder folder;
  write_and_die(folder, 20);
  ASSERT_TRUE(fs::exists(wal_of(folder.log)));
  expect_read_untouched(folder.scratch.path(), folder.log, folder.public_key(), 20);
}

TEST(Reading, ACopyWithItsWalOnlyIsReadAndLeftAlone) {
  const LogFolder folder;
  write_and_die(folder, 20);
  const ScratchFolder elsewhere;
  const fs::path copy = elsewhere / "a copy, 100% ?#.log";
  fs::copy_file(folder.log, copy);
  fs::copy_file(wal_of(folder.log), wal_of(copy));
  expect_read_untouched(elsewhere.path(), copy, folder.public_key(), 20);
}

TEST(Reading, AClosedLogIsOneFileAndLeftAlone) {
  const LogFolder folder(20);
  EXPECT_FALSE(fs::exists(wal_of(folder.log)));
  expect_read_untouched(folder.scratch.path(), folder.log, folder.public_key(), 20);
}

TEST(Reading, EveryStateIsReadInAFolderThatCannotBeWrittenByAnotherUser) {
  const LogFolder closed(5), killed;
  write_and_die(killed, 5);
  const PublicKey key = killed.public_key(), closed_key = closed.public_key();
  for (const LogFolder* folder : {&closed, &killed}) ::chmod(folder->scratch.path().c_str(), 0555);
  const pid_t child = ::fork();
  if (child == 0) {
    if (::geteuid() == 0 && ::setuid(65534) != 0) ::_exit(3);
    const bool read = count_of(verify(closed.log, closed_key)) == 5 && count_of(verify(killed.log, key)) == 5;
    ::_exit(read ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  for (const LogFolder* folder : {&closed, &killed}) ::chmod(folder->scratch.path().c_str(), 0755);
}

// Whatever the WAL is: a finding, or the first of the records that were written. And it is left as it is.
void expect_prefix(const LogFolder& folder, const std::vector<Record>& written) {
  const Snapshot before = snapshot(folder.scratch.path());
  std::vector<Record> read;
  const Verdict verdict =
      verify(folder.log, folder.public_key(), [&](const Record& record) { read.push_back(record); });
  ASSERT_TRUE(snapshot(folder.scratch.path()) == before);
  if (!is_intact(verdict)) return;
  ASSERT_LE(read.size(), written.size());
  for (std::size_t n = 0; n < read.size(); ++n) ASSERT_EQ(hash_of(read[n]), written[n].hash);
}

TEST(Reading, AAlteredOrCutWalGivesAnEarlierPrefixOrAFindingButNoOtherRecord) {
  const LogFolder folder;
  write_and_die(folder, 12);
  const fs::path wal = wal_of(folder.log), shm = folder.log.string() + "-shm";
  const std::string whole = file_content(wal);
  const auto written = records_of(folder.log, folder.public_key());
  ASSERT_EQ(written.size(), 12U);
  std::mt19937 random(3);
  for (const bool shared : {true, false}) {
    if (!shared) fs::remove(shm);
    for (int trial = 0; trial < 200; ++trial) {
      std::string altered = whole;
      altered[random() % altered.size()] ^= static_cast<char>(1U << random() % 8);
      fs::remove(wal);
      write_content(wal, altered);
      expect_prefix(folder, written);
    }
    for (std::size_t size = 0; size < whole.size(); size += size < 64 ? 1 : 397) {
      fs::remove(wal);
      write_content(wal, whole.substr(0, size));
      expect_prefix(folder, written);
    }
  }
}

TEST(Reading, AnEmptyFileIsNoLogAndCostsItsNeighbourNothing) {
  const LogFolder folder;
  write_and_die(folder, 3);
  write_content(folder.log, "");
  const Snapshot before = snapshot(folder.scratch.path());
  EXPECT_EQ(text_of(folder.verdict()), "not a log 0");
  EXPECT_TRUE(snapshot(folder.scratch.path()) == before);
}

}  // namespace
}  // namespace biopsy::recorder
