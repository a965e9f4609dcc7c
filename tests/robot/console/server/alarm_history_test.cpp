// Alarms given by hand; what is kept is read by a second AlarmHistory on the same file, as after a restart.
#include "robot/console/server/alarm_history.hpp"

#include <gtest/gtest.h>

#include "robot/common/files/file.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::console {
namespace {

const events::Alarm kStop{Severity::Alarm, "E-120", "STOP was pressed.", "High voltage off.", "Reset."};
const events::Alarm kDepth{Severity::Warning, "E-204", "Depth limit reached.", "Needle held.", "Retract."};

std::string codes(const AlarmHistory& history) {
  std::string all;
  for (const events::PastAlarm& row : history.event().rows)
    all += row.alarm.code + (row.to_ms == 0.0 ? "* " : " ");
  return all;
}

TEST(AlarmHistory, HasEachAlarmOnceFromItsBeginToItsEndNewestFirst) {
  const ScratchFolder folder;
  AlarmHistory history(folder / "alarms.jsonl");
  for (std::int64_t ms = 100; ms < 200; ++ms) history.update({kDepth}, ms);
  history.update({kStop, kDepth}, 200);
  history.update({kStop}, 300);
  history.update({}, 400);
  history.update({kStop}, 500);  // again: another one
  EXPECT_EQ(codes(history), "E-120* E-120 E-204 ");
  const auto& rows = history.event().rows;
  EXPECT_EQ(rows[2].from_ms, 100.0);
  EXPECT_EQ(rows[2].to_ms, 300.0);
  EXPECT_EQ(rows[1].to_ms, 400.0);
  EXPECT_EQ(rows[0].acknowledged_ms, 0.0);
}

TEST(AlarmHistory, ChangesItsVersionWithEachChangeAndOnlyThen) {
  const ScratchFolder folder;
  AlarmHistory history(folder / "alarms.jsonl");
  auto changed = [&, before = history.version()]() mutable {
    return std::exchange(before, history.version()) != history.version();
  };
  history.update({kStop}, 10);
  EXPECT_TRUE(changed());
  history.update({kStop}, 11);
  EXPECT_FALSE(changed());
  history.acknowledge(1, 12);
  EXPECT_TRUE(changed());
  history.acknowledge(1, 13);
  EXPECT_FALSE(changed());
  history.update({}, 14);
  EXPECT_TRUE(changed());
}

TEST(AlarmHistory, AcknowledgesWhatWasShownAndNotWhatCameMeanwhile) {
  const ScratchFolder folder;
  AlarmHistory history(folder / "alarms.jsonl");
  history.update({kDepth}, 10);
  const std::uint32_t shown = history.event().rows.front().number;
  history.update({kStop, kDepth}, 20);
  history.acknowledge(shown, 30);
  EXPECT_EQ(history.event().rows[0].acknowledged_ms, 0.0);
  EXPECT_EQ(history.event().rows[1].acknowledged_ms, 30.0);
}

TEST(AlarmHistory, OutlivesARestartWhereWhatIsNoLongerActiveHasEnded) {
  const ScratchFolder folder;
  {
    AlarmHistory history(folder / "alarms.jsonl");
    history.update({kDepth}, 10);
    history.acknowledge(1, 15);
    history.note(kStop, 20);
  }
  AlarmHistory again(folder / "alarms.jsonl");
  again.update({}, 1000);
  EXPECT_EQ(codes(again), "E-120 E-204 ");
  EXPECT_EQ(again.event().rows[1].from_ms, 10.0);
  EXPECT_EQ(again.event().rows[1].acknowledged_ms, 15.0);
  EXPECT_EQ(again.event().rows[1].to_ms, 1000.0);
  EXPECT_EQ(again.event().rows[1].alarm.to_do, "Retract.");
  again.update({kDepth}, 1001);
  EXPECT_GT(again.event().rows[0].number, again.event().rows[1].number);
}

TEST(AlarmHistory, GoesOnOverARestartWithWhatIsStillActiveAcknowledgedOrNot) {
  const ScratchFolder folder;
  {
    AlarmHistory history(folder / "alarms.jsonl");
    history.update({kStop}, 10);
    history.acknowledge(1, 15);
    history.update({kDepth, kStop}, 20);
  }
  for (const std::int64_t ms : {1000, 2000}) {  // the second one reads what the first one wrote
    AlarmHistory again(folder / "alarms.jsonl");
    again.update({kStop, kDepth}, ms);
    EXPECT_EQ(codes(again), "E-204* E-120* ");
    EXPECT_EQ(again.event().rows[1].from_ms, 10.0);
    EXPECT_EQ(again.event().rows[1].acknowledged_ms, 15.0);
    EXPECT_EQ(again.event().rows[0].from_ms, 20.0);
    EXPECT_EQ(again.event().rows[0].acknowledged_ms, 0.0);
  }
}

TEST(AlarmHistory, LeavesOutLinesThatCannotBeReadWhereverTheFileIsCut) {
  const ScratchFolder folder;
  {
    AlarmHistory history(folder / "alarms.jsonl");
    history.update({kDepth}, 10);
    history.update({}, 20);
    history.note(kStop, 30);
  }
  const std::string whole = read_file(folder / "alarms.jsonl");
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    folder.write("cut.jsonl", whole.substr(0, length) + (length % 3 == 0 ? "\n{\"number\":-1}\n\xff[]" : ""));
    AlarmHistory cut(folder / "cut.jsonl");
    cut.update({}, 40);
    ASSERT_LE(cut.event().rows.size(), 2U);
    for (const auto& row : cut.event().rows) ASSERT_GT(row.to_ms, 0.0);
    const AlarmHistory again(folder / "cut.jsonl");  // what was written over it is whole
    ASSERT_EQ(codes(again), codes(cut));
  }
}

TEST(AlarmHistory, KeepsTheLastOnesOnly) {
  const ScratchFolder folder;
  AlarmHistory history(folder / "alarms.jsonl");
  for (std::int64_t ms = 1; ms <= 3 * static_cast<std::int64_t>(AlarmHistory::kRowsMax); ++ms)
    history.note(kStop, ms);
  EXPECT_EQ(history.event().rows.size(), AlarmHistory::kRowsMax);
  const AlarmHistory again(folder / "alarms.jsonl");
  ASSERT_EQ(again.event().rows.size(), AlarmHistory::kRowsMax);
  EXPECT_EQ(again.event().rows.front().from_ms, 3.0 * AlarmHistory::kRowsMax);
}

}  // namespace
}  // namespace biopsy::console
