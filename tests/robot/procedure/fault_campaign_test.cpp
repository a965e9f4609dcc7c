// Campaigns of rehearsals with faults. The faults are those of sensors, monitors and amplifiers as an
// assessor lists them, in sizes from harmless to gross; none is made from a monitor's threshold.
#include "robot/procedure/campaign/fault_campaign.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/scratch_folder.hpp"

namespace biopsy::robot {
namespace {

struct Campaign {
  ScratchFolder folder;
  PreparedCase prepared = prepare(read_case("gap"), folder / "case");

  std::vector<EntryResult> run(const std::vector<FaultEntry>& entries, const CampaignOptions& options) const {
    return entry_results(
        run_campaign(prepared, entries, options, folder / "runs", [](double, const std::string&) {}));
  }
};

FaultEntry frozen_with_noise(double noise_mm) {
  return {"frozen",
          FaultBegin::Motion,
          {{.signal = sim::FaultSignal::Depth, .kind = sim::FaultKind::Frozen, .noise = noise_mm}}};
}

TEST(FaultGrid, HasEveryKindOfEverySignalThatCanTakeIt) {
  std::set<std::pair<sim::FaultSignal, sim::FaultKind>> depth;
  std::set<std::string> names;
  int voltage = 0, current = 0, drive = 0;
  for (const FaultEntry& entry : fault_grid()) {
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    for (const sim::Fault& fault : entry.faults) {
      if (fault.signal == sim::FaultSignal::Depth) depth.insert({fault.signal, fault.kind});
      voltage += fault.signal == sim::FaultSignal::VoltageMonitor;
      current += fault.signal == sim::FaultSignal::CurrentMonitor;
      drive += fault.signal == sim::FaultSignal::Drive;
    }
  }
  EXPECT_EQ(depth.size(), 11U);  // all but oscillation and a missing polarity, which are the drive's
  EXPECT_GE(voltage, 10);
  EXPECT_GE(current, 3);
  EXPECT_GE(drive, 20);
}

TEST(FaultCampaign, ALaserThatStandsStillWithNoiseStopsTheNeedleShortOfTheTarget) {
  const std::vector<EntryResult> found =
      Campaign().run({frozen_with_noise(0.010), frozen_with_noise(0.037)}, {.runs = 4, .seed = 11});
  for (const EntryResult& one : found) {
    EXPECT_EQ(one.runs, 4);
    EXPECT_EQ(one.began, 4);
    EXPECT_EQ(one.completed, 0);
    EXPECT_EQ(one.beyond, 0);
    EXPECT_LT(one.worst_mm, 0.6);  // it began before the target, and 0.3 mm is the bound of two lasers
    ASSERT_EQ(one.detected_by.size(), 1U);
    EXPECT_TRUE(one.detected_by.begin()->first.starts_with("H-10"));
  }
}

TEST(FaultCampaign, SameSeedsGiveTheSameRunsWhateverRunsBesideThem) {
  const Campaign campaign;
  const auto alone = campaign.run({frozen_with_noise(0.02)}, {.runs = 2, .seed = 5});
  const auto beside =
      campaign.run({frozen_with_noise(0.05), frozen_with_noise(0.02)}, {.runs = 2, .seed = 5});
  EXPECT_EQ(alone[0].worst_mm, beside[1].worst_mm);
  EXPECT_EQ(alone[0].worst_from_depth_mm, beside[1].worst_from_depth_mm);
  EXPECT_EQ(alone[0].detected_ms_max, beside[1].detected_ms_max);
}

TEST(FaultCampaign, AStopLeavesNoRunThatWasNotRun) {
  std::stop_source source;
  source.request_stop();
  const auto found =
      Campaign().run({frozen_with_noise(0.02)}, {.runs = 3, .seed = 1, .stop = source.get_token()});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].runs, 0);
  EXPECT_EQ(found[0].beyond_upper95(), 1.0);
}

// An assessor's own beginning. The offset is too small to be seen; the needle ends as far off as it is.
TEST(FaultCampaign, SaysWhereAFaultOfAFileBeganAndHowFarOffTheNeedleWasLeft) {
  const Campaign campaign;
  const FaultEntry entry{"offset",
                         FaultBegin::Start,
                         {{.signal = sim::FaultSignal::Depth,
                           .kind = sim::FaultKind::Offset,
                           .from_depth_mm = 0.83,
                           .value = -0.15}}};
  const EntryResult one = campaign.run({entry}, {.runs = 2, .seed = 41}).at(0);
  EXPECT_EQ(one.worst_from_depth_mm, 0.83);
  ASSERT_EQ(one.completed, 2);
  EXPECT_NEAR(one.completed_off_mm, 0.15, 0.08);
}

// A brake that grips late lets the needle sink meanwhile: it is locked and does not stand still, which no
// hazard names.
TEST(FaultCampaign, AHoldThatLastedTooLongIsAStopThatIsCountedAndExplained) {
  const Campaign campaign;
  const report::RunRecord run =
      rehearse(campaign.prepared, campaign.folder / "run", [](double, const std::string&) {}, {},
               {{.signal = sim::FaultSignal::Brake, .kind = sim::FaultKind::Lag, .value = 900.0}});
  ASSERT_EQ(run.outcome, report::Outcome::Stopped);
  ASSERT_NE(run.refusal.find("held too long"), std::string::npos) << run.refusal;
  ASSERT_EQ(run.trips.size(), 1U);
  EXPECT_EQ(run.trips[0].reason, "held too long");
  EXPECT_EQ(run.faults.at(0).detected_by, "held too long");
  EXPECT_NE(run.remedy.find("brake"), std::string::npos);
  const auto hold = std::ranges::find(run.limits, "longest hold", &report::LimitUse::name);
  ASSERT_NE(hold, run.limits.end());
  EXPECT_NEAR(hold->used, 10.0, 0.01);
  const Plan& plan = *run.plan;
  EXPECT_EQ(run.layer_at_tip, plan.layer_at(Millimetres(run.true_final_depth_mm)));
}

// Clopper and Pearson 1934: none of n is 1 - 0.05^(1/n); the second figure is from R's binom.test.
TEST(FaultCampaign, BoundOfTheShareIsClopperAndPearsons) {
  EntryResult result;
  result.runs = 299;
  EXPECT_NEAR(result.beyond_upper95(), 1.0 - std::pow(0.05, 1.0 / 299.0), 1e-9);
  result.runs = 20, result.beyond = 1;
  EXPECT_NEAR(result.beyond_upper95(), 0.2161, 1e-4);
}

TEST(FaultCampaign, NoFaultOfTheGridTakesTheNeedleBeyondTheTargetAndTwoMillimetres) {
  const std::vector<EntryResult> found = Campaign().run(fault_grid(), {.runs = 1, .seed = 71});
  for (const EntryResult& one : found) {
    EXPECT_EQ(one.beyond, 0) << one.name << ": " << one.worst_mm << " mm";
    EXPECT_LE(one.completed_off_mm, 0.5)
        << one.name;  // 0.3 mm of the lasers, 0.1 of the loop, 0.1 of the image
  }
}

// Without an image that could catch a fault, over more stages, tissues and moments.
TEST(FaultCampaign, NoFaultOfTheGridDoesSoWhereEachImageIsAcceptedUnseen) {
  Campaign campaign;
  campaign.prepared.given.rehearsal.accept_unseen = true;
  for (const EntryResult& one : campaign.run(fault_grid(), {.runs = 3, .seed = 2301}))
    EXPECT_EQ(one.beyond, 0) << one.name << ": " << one.worst_mm << " mm, seed " << one.worst_seed;
}

// The needle is where the stage left it, image or not: the same faults, moments and noise.
TEST(FaultCampaign, AnImageAcceptedUnseenMovesNothing) {
  Campaign campaign;
  const CampaignOptions options{.runs = 3, .seed = 29};
  const std::vector<FaultEntry> faults{
      frozen_with_noise(0.01),
      {"scale",
       FaultBegin::Motion,
       {{.signal = sim::FaultSignal::Depth, .kind = sim::FaultKind::Scale, .value = 0.99}}}};
  const auto seen = campaign.run(faults, options);
  campaign.prepared.given.rehearsal.accept_unseen = true;
  const auto unseen = campaign.run(faults, options);
  for (std::size_t i = 0; i < faults.size(); ++i) {
    EXPECT_EQ(seen[i].worst_mm, unseen[i].worst_mm);
    EXPECT_EQ(seen[i].detected_by, unseen[i].detected_by);
  }
  EXPECT_EQ(seen[1].completed, 3);
  EXPECT_EQ(unseen[1].completed, 3);
}

}  // namespace
}  // namespace biopsy::robot
