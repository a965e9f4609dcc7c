// kill -9 of a recorder at any moment: records reported as written are there, and the log is a valid prefix.
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "tests/robot/recorder/log_for_tests.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::recorder {
namespace {

// Appends as fast as it can and reports the number of records after each commit; never returns.
[[noreturn]] void record_until_killed(const LogFolder& folder, int round, int acknowledge) {
  Recorder recorder(folder.log, folder.key());
  std::uint64_t reported = 0;
  const auto report = [&] {
    reported = recorder.written().count;
    if (::write(acknowledge, &reported, sizeof(reported)) != sizeof(reported)) ::_exit(1);
  };
  report();
  std::mt19937 random(static_cast<unsigned>(round));
  for (std::int64_t n = 1;; ++n) {
    const std::string body = std::to_string(round) + ":" + std::to_string(n) + ":";
    recorder.append(entry(n, body + std::string(random() % 4000, '.')),
                    random() % 32 ? Urgency::Grouped : Urgency::Urgent, n * 1000);
    recorder.poll(n * 1000);
    if (recorder.written().count != reported) report();
  }
}

struct Child {
  pid_t process = 0;
  int acknowledged = 0;  // to be read

  void wait_until_open() const {
    pollfd opened{.fd = acknowledged, .events = POLLIN, .revents = 0};
    ::poll(&opened, 1, -1);
  }
};

Child start(const LogFolder& folder, int round) {
  int ends[2];
  EXPECT_EQ(::pipe(ends), 0);
  const pid_t process = ::fork();
  if (process == 0) {
    ::close(ends[0]);
    record_until_killed(folder, round, ends[1]);
  }
  ::close(ends[1]);
  return {process, ends[0]};
}

struct Killed {
  bool opened = false;
  std::uint64_t acknowledged = 0;
};

Killed kill_now(const Child& child) {
  ::kill(child.process, SIGKILL);
  int status = 0;
  ::waitpid(child.process, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status));
  Killed killed;
  while (::read(child.acknowledged, &killed.acknowledged, sizeof(std::uint64_t)) == sizeof(std::uint64_t))
    killed.opened = true;
  ::close(child.acknowledged);
  return killed;
}

// The records that a round added are its first ones, none left out.
void expect_rounds_without_gaps(const std::vector<Record>& records) {
  std::string round;
  std::int64_t next = 1;
  for (const Record& record : records) {
    const std::size_t colon = record.body.find(':');
    if (record.body.substr(0, colon) != round) next = 1;
    round = record.body.substr(0, colon);
    ASSERT_EQ(record.body.find(std::to_string(next) + ":", colon + 1), colon + 1)
        << record.body.substr(0, 20);
    ++next;
  }
}

TEST(Kill, AtAnyMomentLeavesAValidPrefixWithAllThatWasAcknowledged) {
  verifies("R-45");
  constexpr int kRounds = 200, kRoundsOfOneLog = 10;
  std::mt19937 random(2026);
  std::unique_ptr<LogFolder> folder;
  std::uint64_t written = 0;
  int rounds_with_records = 0;
  for (int round = 0; round < kRounds; ++round) {
    if (round % kRoundsOfOneLog == 0) folder = std::make_unique<LogFolder>();
    const Child child = start(*folder, round);
    // Half of the moments are counted from the fork, so that some fall into making or opening the log.
    if (random() % 2) child.wait_until_open();
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 20'000));
    const Killed killed = kill_now(child);
    if (!killed.opened && !fs::exists(folder->log)) continue;  // killed while it was made
    std::vector<Record> records;
    const Verdict verdict =
        verify(folder->log, folder->public_key(), [&](const Record& record) { records.push_back(record); });
    ASSERT_TRUE(is_intact(verdict)) << "round " << round << ": " << std::get<Flaw>(verdict).what;
    ASSERT_EQ(count_of(verdict), records.size());
    ASSERT_GE(records.size(), killed.acknowledged) << "round " << round;
    expect_rounds_without_gaps(records);
    written += killed.acknowledged;
    rounds_with_records += killed.acknowledged > 0 ? 1 : 0;
  }
  EXPECT_GT(rounds_with_records, kRounds / 4);
  EXPECT_GT(written, 1000U);
  Recorder recorder(folder->log, folder->key());
  recorder.append(entry(1, "200:1:"), Urgency::Urgent, 0);
  EXPECT_TRUE(recorder.last_error().empty()) << "and the log goes on";
}

TEST(Kill, ALogIsReadInAnyMomentWhileAnotherProcessWritesIt) {
  const LogFolder folder;
  const Child child = start(folder, 1);
  child.wait_until_open();
  std::uint64_t before = 0;
  constexpr int kLeast = 20, kMost = 5'000;  // as many as it takes until something was written meanwhile
  for (int reading = 0; reading < kLeast || (before <= 100 && reading < kMost); ++reading) {
    const Verdict verdict = folder.verdict();
    EXPECT_TRUE(is_intact(verdict)) << text_of(verdict);
    EXPECT_GE(count_of(verdict), before);
    before = count_of(verdict);
  }
  const Killed killed = kill_now(child);
  // What was read stays; it may be more than was reported, for the last report may not have been sent.
  const Verdict at_last = folder.verdict();
  EXPECT_TRUE(is_intact(at_last)) << text_of(at_last);
  EXPECT_GE(count_of(at_last), std::max(before, killed.acknowledged));
  EXPECT_GT(before, 100U);
}

}  // namespace
}  // namespace biopsy::recorder
