// Double entry: tables and constants of the build against those people read, and against the literature.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "safety/interlock.hpp"
#include "safety/monitors/depth_monitor.hpp"
#include "safety/monitors/tissue_monitor.hpp"
#include "safety/types/limits.hpp"
#include "safety/types/thresholds.hpp"
#include "safety/types/transitions.hpp"
#include "tests/safety/verifies.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::safety {
namespace {

using Constants = std::vector<std::int64_t>;

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

TEST(DoubleEntry, AnEventLeadsWhereItsRowSays) {
  for (const Transition& way : kTransitions)
    EXPECT_EQ(next_mode(way.from, way.event), way.to) << name_of(way.from) << ": " << name_of(way.event);
}

TEST(DoubleEntry, TheTableHasARowForEachHazardInItsOrder) {
  EXPECT_TRUE(is_ordered_by_severity());
  for (std::size_t i = 0; i < kHazards; ++i) EXPECT_EQ(kHazardTable[i].hazard, static_cast<Hazard>(i));
}

TEST(DoubleEntry, ClocksAndMessagesHaveTheLimitsOfTheSafetyConcept) {
  verifies("R-04", "R-05", "R-10", "R-18", "R-24", "R-26", "R-28", "R-33");
  EXPECT_EQ((Constants{kClockStepMax_us, kStale_ticks, kInterlock_us, kScoreWrong, kScoreTrip, kScoreMax,
                       kAnswerWindow, kMiss, kMissTrip, kMissMax, kEStopDisagree_ticks, kLogBacklog_ms,
                       kPatientMotion_um, kSuspect_ticks, kWrongModel_ticks}),
            (Constants{5'000, 3, 20'000, 2, 2, 4, 5, 100, 200, 400, 20, 1'000, 2'000, 100, 1'100}));
  EXPECT_EQ((Constants{kElapsedMax_ms, kStageLate_us, kContact_ticks, kPanelRead_us, kRelay_ticks,
                       kPanelTest_us, kComes_goes}),
            (Constants{6, 1'750, 20, 20'000, 30, 86'400'000'000, 2}));
}

TEST(DoubleEntry, VoltagesHaveTheLimitsOfTheSafetyConcept) {
  verifies("R-01", "R-06", "R-07", "R-08", "R-09", "R-22", "R-23");
  EXPECT_EQ(
      (Constants{kOverVoltage_ticks, kDisagree_ticks, kDisagree_percent, kDisagreeFloor_mV, kDisobey_ticks,
                 kDisobey_mV, kZero_ticks, kResidual_ticks, kCapacitive_nA_per_mV, kArcMargin_nA, kArc_ticks,
                 kWaveMin_mV, kHalfPeriod_ticks, kBenchHalfPeriodMin_ticks, kBenchHalfPeriodMax_ticks,
                 kTwoPeriods_half_periods, kOffOneIn, kForget_ticks, kForgetPerSeen}),
      (Constants{2, 3, 3, 100'000, 3, 200'000, 3, 200, 2, 1'000'000, 2, 1'000'000, 250, 50, 2'500, 4, 5,
                 2'048, 2}));
  EXPECT_EQ((Constants{kPastLocked_mV, kPull_ticks, kPullLead_V2}), (Constants{1'200'000, 128, 1'200'000}));
}

TEST(DoubleEntry, DepthsHaveTheLimitsOfTheSafetyConcept) {
  verifies("R-02", "R-14", "R-15", "R-16", "R-17", "R-19", "R-20", "R-21");
  EXPECT_EQ((Constants{kDepth_ticks, kReaction_us, kDecel_um_per_s2, kFastDrop_um_per_s, kPopThrough_um,
                       kDropout_ticks, kFrozen_ticks, kFrozenMove_mV, kImplausible_um, kImplausible_ticks,
                       kNotBack_ticks, DepthHistory::kSpan_ticks, kMean_ticks}),
            (Constants{2, 5'000, 5'000'000, 50'000, 800, 3, 20, 200'000, 1'000, 50, 500, 10, 512}));
  EXPECT_EQ(
      (Constants{kDropoutTrip, kAdvanced_um, kIdlePull_V2, kIdle_ticks, kLifted_um, kLiftPulls, kDiffer_um,
                 kDiffer_ticks, kDifferWeight, kDifferTrip, kLowered_mV, kSunk_um, kSunk_ticks,
                 kCreeping_ticks, kSettling_ticks, kStillNoise_um, kSlip_ticks}),
      (Constants{6, 100, 24'000'000, 20, 1'000, 3, 300, 10, 4, 40, 200'000, 600, 20, 4'000, 250, 25, 20}));
}

TEST(DoubleEntry, TheSupervisorsTimesAreThoseOfTheSafetyConcept) {
  EXPECT_EQ((Constants{kBootMax_ms, kHeldTimeout_ms, kRamp_ms}), (Constants{10'000, 100, 250}));
}

TEST(DoubleEntry, TheRobotsHardLimitsAreThoseOfThePaperAndTheSafetyConcept) {
  EXPECT_EQ((Constants{limits::kDriveMax_mV, limits::kMonitorTrip_mV, limits::kZeroVolt_mV,
                       limits::kSlewUpMax_mV_per_tick, limits::kRampTime_ms, limits::kStroke_um,
                       limits::kDepthMargin_um, limits::kDepthHard_um, limits::kReturned_um, limits::kBack_um,
                       limits::kStill_um, limits::kPermitTtl_us, limits::kHoldMax_ms, limits::kLockedMax_ms,
                       limits::kArmedMax_ms}),
            (Constants{8'000'000, 8'200'000, 100'000, 400'000, 300, 12'000, 1'000, 2'000, 1'000, 100, 100,
                       5'000, 10'000, 180'000, 30'000}));
}

}  // namespace
}  // namespace biopsy::safety
