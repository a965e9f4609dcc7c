// The depth check on pairs of real scans (../shared/data/images/mr), in which nothing but a needle painted by
// this test is known: verdicts by kind of error, and whether standard deviations mean what they say.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "planner/imaging/depth_check/depth_check.hpp"
#include "planner/imaging/io/read_volume.hpp"
#include "tests/planner/imaging/rescan/rescan_case.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::imaging::rescan {
namespace {

constexpr double kDegreesPerRadian = 57.29577951308232;

struct Outcome {
  DepthCheck check;
  double depth_error_mm = 0.0, lateral_error_mm = 0.0, angle_error_deg = 0.0;
};

// The painted void ends at the tip, but for what rounds it.
DepthCheckSettings settings_of(const RescanCase& c) {
  DepthCheckSettings settings;
  settings.expected = Millimetres(c.plan_depth_mm);
  settings.tip_offset = TipOffset{"painted", "rescan", Millimetres(c.needle.beyond_mm), Millimetres(0.15)};
  return settings;
}

Outcome checked(const RescanCase& c) {
  Outcome outcome;
  outcome.check = check_depth(c.before, c.after, c.plan_p_SE, c.plan_axis_S, settings_of(c));
  const NeedleFrame frame = needle_frame(c.after.grid, c.plan_p_SE, c.plan_axis_S);
  const Eigen::Vector3d tip = frame.coordinates(c.needle.p_SE + c.needle.tip_mm * c.needle.axis_S);
  outcome.depth_error_mm = outcome.check.depth.value - tip.x();
  outcome.lateral_error_mm = outcome.check.lateral_mm - tip.tail<2>().norm();
  outcome.angle_error_deg = outcome.check.angle_deg -
                            std::acos(std::min(frame.along.dot(c.needle.axis_S), 1.0)) * kDegreesPerRadian;
  return outcome;
}

// Half a slice where slices are thicker than 2 mm.
double harm_mm(const Volume& after) {
  const double slice = after.grid.spacing_mm().maxCoeff();
  return slice > 2.0 ? 0.5 * slice : 1.0;
}

struct Tally {
  int count = 0, accepted = 0, rejected = 0, accepted_wrong = 0;
  double accepted_share() const { return count > 0 ? static_cast<double>(accepted) / count : 0.0; }
  double rejected_share() const { return count > 0 ? static_cast<double>(rejected) / count : 0.0; }
};

Tally tally_of(const Pair& pair, Kind kind, std::uint64_t first, std::uint64_t count,
               std::vector<Outcome>* outcomes = nullptr) {
  Tally tally;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    const auto c = drawn(pair, kind, seed);
    if (!c) continue;
    const Outcome outcome = checked(*c);
    const bool accepted = outcome.check.verdict == DepthVerdict::Accept;
    ++tally.count;
    tally.accepted += accepted;
    tally.rejected += outcome.check.verdict == DepthVerdict::Reject;
    tally.accepted_wrong += accepted && std::abs(outcome.depth_error_mm) > harm_mm(c->after);
    if (outcomes) outcomes->push_back(outcome);
  }
  fmt::print("  {:12s} {:20s} accept {:3d}  reject {:3d}  unsure {:3d}  accepted and wrong {}\n", pair.name,
             label(kind), tally.accepted, tally.rejected, tally.count - tally.accepted - tally.rejected,
             tally.accepted_wrong);
  return tally;
}

constexpr std::array kNeverAccepted{Kind::Depth3mm, Kind::Depth8mm,     Kind::Beside5mm, Kind::Tilted6deg,
                                    Kind::NoNeedle, Kind::OtherPatient, Kind::Swapped};

void expect_the_bar(const std::string& name, std::uint64_t of_right, std::uint64_t of_wrong) {
  const auto pair = real_pair(name);
  if (!pair) GTEST_SKIP() << "no real images beside the source folder";
  const Tally right = tally_of(*pair, Kind::RightPlan, 101, of_right);
  EXPECT_GE(right.accepted_share(), 0.6);
  EXPECT_EQ(right.accepted_wrong, 0);
  EXPECT_EQ(tally_of(*pair, Kind::OldTrack, 101, of_wrong).accepted_wrong, 0);
  for (const Kind kind : kNeverAccepted) {
    const Tally tally = tally_of(*pair, kind, 101, of_wrong);
    EXPECT_EQ(tally.accepted, 0) << label(kind);
    if (kind == Kind::Depth8mm) {
      EXPECT_GE(tally.rejected_share(), 0.7);
    }
  }
}

TEST(RescanCheck, MeetsTheBarOnAFewNeedlesInARescan) {
  expect_the_bar("rescan", 10, 2);
}

TEST(RescanCampaign, MeetsTheBarInARescan) {
  expect_the_bar("rescan", 60, 12);
}

TEST(RescanCampaign, MeetsTheBarInTheRescanTakenTheOtherWay) {
  expect_the_bar("rescan_back", 60, 12);
}

// Another sequence, resolution and day's position: fewer decisions, no wrong one.
TEST(RescanCampaign, NeverAcceptsWronglyBetweenPlanningAndGuidance) {
  const auto pair = real_pair("planning");
  if (!pair) GTEST_SKIP() << "no real images beside the source folder";
  const Tally right = tally_of(*pair, Kind::RightPlan, 101, 40);
  EXPECT_EQ(right.accepted_wrong, 0);
  EXPECT_GE(right.accepted_share(), 0.45);
  for (const Kind kind : kNeverAccepted) {
    const Tally tally = tally_of(*pair, kind, 101, 10);
    EXPECT_EQ(tally.accepted, 0) << label(kind);
    if (kind == Kind::Depth8mm) {
      EXPECT_GE(tally.rejected_share(), 0.6);
    }
  }
}

// Of the needles that are seen, whatever the verdict: errors within one and two standard deviations.
TEST(RescanCampaign, StatesStandardDeviationsThatHold) {
  const auto pair = real_pair("rescan");
  if (!pair) GTEST_SKIP() << "no real images beside the source folder";
  std::vector<Outcome> outcomes;
  tally_of(*pair, Kind::RightPlan, 301, 50, &outcomes);
  tally_of(*pair, Kind::Beside5mm, 301, 25, &outcomes);
  tally_of(*pair, Kind::Tilted6deg, 301, 25, &outcomes);
  int seen = 0;
  std::array<int, 3> within{};
  for (const Outcome& o : outcomes) {
    if (!o.check.tip_found) continue;
    ++seen;
    within[0] += std::abs(o.depth_error_mm) < 2.0 * o.check.sigma.value;
    // A length beside zero is read too large by about its standard deviation.
    within[1] += std::abs(o.lateral_error_mm) < 2.5 * o.check.lateral_sigma_mm + 0.1;
    within[2] += std::abs(o.angle_error_deg) < 2.5 * o.check.angle_sigma_deg + 0.1;
  }
  fmt::print("  {} seen; within two standard deviations: depth {}, lateral {}, angle {}\n", seen, within[0],
             within[1], within[2]);
  for (int count : within) EXPECT_GE(count, 0.9 * seen);
}

// A real needle (../shared/data/images/needle/gel_a): what its void goes on beyond the tip is not known here.
TEST(RescanCheck, AcceptsNoRealNeedleWithoutACalibration) {
  const auto folder = source_dir() / "../shared/data/images/needle/gel_a";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no real images beside the source folder";
  const Volume before = read_volume(folder / "base_mag.nrrd"),
               after = read_volume(folder / "needle_mag.nrrd");
  for (const double expected : {30.0, 40.0, 43.0, 45.0, 48.3}) {
    DepthCheckSettings settings;
    settings.expected = Millimetres(expected);
    const DepthCheck check =
        check_depth(before, after, Point(-9.2, 22.0, 20.0), Direction(0, 0, 1), settings);
    EXPECT_NE(check.verdict, DepthVerdict::Accept) << check.reason;
  }
}

}  // namespace
}  // namespace biopsy::imaging::rescan
