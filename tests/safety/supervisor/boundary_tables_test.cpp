// Double entry: the tables and constants of the build against those people read, and against the literature.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "safety/challenge.hpp"
#include "safety/interlock.hpp"
#include "safety/monitors/depth_monitor.hpp"
#include "safety/monitors/tissue_monitor.hpp"
#include "safety/types/hazards.hpp"
#include "safety/types/limits.hpp"
#include "safety/types/thresholds.hpp"
#include "safety/types/transitions.hpp"
#include "tests/safety/verifies.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::safety {
namespace {

std::string section(const std::string& title) {
  std::ifstream file(source_dir() / "docs/reference/supervisor.md");
  std::stringstream text;
  text << file.rdbuf();
  const std::string all = text.str();
  const std::size_t start = all.find("\n## " + title + "\n");
  return all.substr(start, all.find("\n## ", start + 1) - start);
}

// The first cells of each line of the table in a section, trimmed and joined by "|".
std::set<std::string> rows(const std::string& title, int cells) {
  std::set<std::string> found;
  std::istringstream lines(section(title));
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("| ")) continue;
    std::istringstream row(line.substr(2));
    std::string joined, cell;
    for (int i = 0; i < cells && std::getline(row, cell, '|'); ++i) {
      const std::size_t first = cell.find_first_not_of(' ');
      if (first != std::string::npos) joined += cell.substr(first, cell.find_last_not_of(' ') + 1 - first);
      joined += '|';
    }
    found.insert(joined);
  }
  return found;
}

TEST(DoubleEntry, TheHazardsOfTheBuildAreThoseInTheDocument) {
  std::set<std::string> built{"hazard|what|stop|detected within, ms|monitor|threshold|requirement|"};
  for (const HazardFacts& facts : kHazardTable) {
    constexpr const char* kStops[] = {"none", "C2", "C1", "C0"};
    const std::string stop = kStops[static_cast<int>(facts.stop)];
    built.insert(std::string(facts.name.substr(0, 4)) + '|' + std::string(facts.name.substr(5)) + '|' + stop +
                 (facts.locks ? ", lock|" : "|") + std::to_string(facts.detect_ms) + '|' +
                 std::string(name_of(facts.monitor)) + '|' + std::string(facts.threshold) + '|' +
                 std::string(facts.requirement) + '|');
  }
  EXPECT_EQ(built, rows("Hazards", 7));
}

// Of the hazards in the risk analysis: id to the list of its requirements, as text.
std::map<std::string, std::string> analysed_hazards() {
  std::ifstream file(source_dir() / "safety/case/hazards.toml");
  std::map<std::string, std::string> found;
  std::string id;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("id = \"")) id = line.substr(6, 4);
    if (line.starts_with("requirements = ")) found[id] = line;
  }
  return found;
}

TEST(DoubleEntry, EachMonitoredHazardIsOneOfTheRiskAnalysisWithItsRequirement) {
  const std::map<std::string, std::string> analysed = analysed_hazards();
  for (const HazardFacts& facts : kHazardTable) {
    const auto hazard = analysed.find(std::string(facts.name.substr(0, 4)));
    ASSERT_NE(hazard, analysed.end()) << facts.name;
    EXPECT_NE(hazard->second.find(facts.requirement), std::string::npos)
        << facts.name << ": " << hazard->second;
  }
}

TEST(DoubleEntry, TheWaysBetweenStatesAreThoseInTheDocument) {
  std::set<std::string> built, told;
  for (const Transition& way : kTransitions)
    built.insert(std::string(name_of(way.from)) + ": " + std::string(name_of(way.event)) + " → " +
                 std::string(name_of(way.to)));
  for (const std::string& row : rows("States", 3)) {
    const std::string from = row.substr(0, row.find('|')),
                      ways = row.substr(row.find('|', from.size() + 1) + 1);
    std::istringstream parts(ways.substr(0, ways.size() - 1));
    for (std::string way; std::getline(parts, way, ';');)
      if (way.find("→") != std::string::npos)
        told.insert(from + ": " + way.substr(way.find_first_not_of(' ')));
  }
  EXPECT_EQ(built, told);
}

TEST(DoubleEntry, TheTableHasARowForEachHazardInItsOrder) {
  EXPECT_TRUE(is_ordered_by_severity());
  for (std::size_t i = 0; i < kHazards; ++i) EXPECT_EQ(kHazardTable[i].hazard, static_cast<Hazard>(i));
}

TEST(DoubleEntry, ClocksAndMessagesHaveTheLimitsOfTheSafetyConcept) {
  verifies("R-04", "R-05", "R-10", "R-18", "R-24", "R-26", "R-28", "R-33");
  EXPECT_EQ(kClockStepMax_us, 5'000);
  EXPECT_EQ(kStale_ticks, 3);
  EXPECT_EQ(kInterlock_us, 20'000);
  EXPECT_EQ(kScoreWrong, 2);
  EXPECT_EQ(kScoreTrip, 2);
  EXPECT_EQ(kScoreMax, 4);
  EXPECT_EQ(kAnswerWindow, 5U);
  EXPECT_EQ(kMiss, 100);
  EXPECT_EQ(kMissTrip, 200);
  EXPECT_EQ(kMissMax, 400);
  EXPECT_EQ(kEStopDisagree_ticks, 20);
  EXPECT_EQ(kLogBacklog_ms, 1'000);
  EXPECT_EQ(kPatientMotion_um, 2'000);
  EXPECT_EQ(kSuspect_ticks, 100);
  EXPECT_EQ(kWrongModel_ticks, 1'100);
}

TEST(DoubleEntry, VoltagesHaveTheLimitsOfTheSafetyConcept) {
  verifies("R-01", "R-06", "R-07", "R-08", "R-09", "R-22", "R-23");
  EXPECT_EQ(kOverVoltage_ticks, 2);
  EXPECT_EQ(kDisagree_ticks, 3);
  EXPECT_EQ(kDisagree_percent, 3);
  EXPECT_EQ(kDisagreeFloor_mV, 100'000);
  EXPECT_EQ(kDisobey_ticks, 3);
  EXPECT_EQ(kDisobey_mV, 200'000);
  EXPECT_EQ(kZero_ticks, 3);
  EXPECT_EQ(kResidual_ticks, 200);
  EXPECT_EQ(kCapacitive_nA_per_mV, 2);
  EXPECT_EQ(kArcMargin_nA, 1'000'000);
  EXPECT_EQ(kArc_ticks, 2);
  EXPECT_EQ(kWaveMin_mV, 1'000'000);
  EXPECT_EQ(kHalfPeriod_ticks, 250);
  EXPECT_EQ(kBenchHalfPeriodMin_ticks, 50);
  EXPECT_EQ(kBenchHalfPeriodMax_ticks, 2'500);
  EXPECT_EQ(kTwoPeriods_half_periods, 4);
  EXPECT_EQ(kOffOneIn, 5);
  EXPECT_EQ(kForget_ticks, 2'048);
  EXPECT_EQ(kForgetPerSeen, 2);
}

TEST(DoubleEntry, DepthsHaveTheLimitsOfTheSafetyConcept) {
  verifies("R-02", "R-14", "R-15", "R-16", "R-17", "R-19", "R-20", "R-21");
  EXPECT_EQ(kDepth_ticks, 2);
  EXPECT_EQ(kReaction_us, 5'000);
  EXPECT_EQ(kDecel_um_per_s2, 5'000'000);
  EXPECT_EQ(kFastDrop_um_per_s, 50'000);
  EXPECT_EQ(kPopThrough_um, 800);
  EXPECT_EQ(kDropout_ticks, 3);
  EXPECT_EQ(kFrozen_ticks, 20);
  EXPECT_EQ(kFrozenMove_mV, 200'000);
  EXPECT_EQ(kImplausible_um, 1'000);
  EXPECT_EQ(kImplausible_ticks, 50);
  EXPECT_EQ(kNotBack_ticks, 500);
  EXPECT_EQ(DepthHistory::kSpan_ticks, 10);
  EXPECT_EQ(kMean_ticks, 512);
}

TEST(DoubleEntry, TheSupervisorsTimesAreThoseOfTheSafetyConcept) {
  EXPECT_EQ(kBootMax_ticks, 10'000);
  EXPECT_EQ(kHeldTimeout_ticks, 100);
  EXPECT_EQ(kRamp_ticks, 250);
}

TEST(DoubleEntry, TheRobotsHardLimitsAreThoseOfThePaperAndTheSafetyConcept) {
  EXPECT_EQ(limits::kDriveMax_mV, 8'000'000);
  EXPECT_EQ(limits::kMonitorTrip_mV, 8'200'000);
  EXPECT_EQ(limits::kZeroVolt_mV, 100'000);
  EXPECT_EQ(limits::kSlewUpMax_mV_per_tick, 400'000);
  EXPECT_EQ(limits::kRampTime_ms, 300);
  EXPECT_EQ(limits::kStroke_um, 12'000);
  EXPECT_EQ(limits::kDepthMargin_um, 1'000);
  EXPECT_EQ(limits::kDepthHard_um, 2'000);
  EXPECT_EQ(limits::kReturned_um, 1'000);
  EXPECT_EQ(limits::kPermitTtl_us, 5'000);
  EXPECT_EQ(limits::kHoldMax_ms, 10'000);
  EXPECT_EQ(limits::kArmedMax_ms, 30'000);
}

TEST(Challenge, MixesAsTheFinaliserOfMurmurHash3Does) {
  EXPECT_EQ(mix(0), 0U);
  EXPECT_EQ(mix(1), 0x514E'28B7U);
  EXPECT_EQ(mix(2), 0x30F4'C306U);
  EXPECT_EQ(mix(0x1234'5678), 0xE37C'D1BCU);
  EXPECT_EQ(mix(0xFFFF'FFFF), 0x81F1'6F39U);
}

// Reckoned apart from this code. A driver by somebody else has to give the same answers.
TEST(Challenge, AsksAndAnswersWhatADriverBySomebodyElseReckonsToo) {
  verifies("R-10");
  EXPECT_EQ(challenge_of(7, 1), 0x72E7'EF71U);
  EXPECT_EQ(challenge_of(1'700'000'000, 123'456), 0xFE90'5888U);
  EXPECT_EQ(answer_to(0xABCD, -5'000'000, Mode::Active, 77), 0xDD6C'0AACU);
  EXPECT_EQ(answer_to(1, 8'000'000, Mode::Hold, 4'000'000'000), 0x5D40'A7BDU);
}

TEST(Interlock, ClosesAtTheInstantOfTheSecondFeeding) {
  const Interlock one = feed_from_supervisor(Interlock{}, 500);
  EXPECT_FALSE(is_closed(one, 500));
  EXPECT_TRUE(is_closed(feed_from_driver(one, 500), 500));
  EXPECT_FALSE(is_closed(feed_from_driver(one, 501), 500)) << "fed in the future: the clock is wrong";
}

}  // namespace
}  // namespace biopsy::safety
