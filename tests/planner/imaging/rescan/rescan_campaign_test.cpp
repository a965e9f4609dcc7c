// The depth check on pairs of real scans (../shared/data/images/mr), in which nothing but a needle painted by
// this test is known: verdicts by kind of error, and whether standard deviations mean what they say.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "planner/imaging/depth_check/depth_check.hpp"
#include "planner/imaging/io/read_volume.hpp"
#include "tests/planner/imaging/rescan/rescan_case.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::imaging::rescan {
namespace {

constexpr double kDegreesPerRadian = 57.29577951308232;

// One case and what the images say of it: the same for whatever depth was planned.
struct Read {
  RescanCase c;
  NeedleFrame frame;
  DepthReading reading;
  DepthCheckSettings settings;

  bool seen() const { return needle_seen(reading.tip, settings); }
  NeedlePlacement placement() const { return placement_of(reading.tip, settings); }
  Eigen::Vector3d tip() const { return frame.coordinates(c.needle.p_SE + c.needle.tip_mm * c.needle.axis_S); }
  double depth_error_mm() const { return placement().depth_mm - tip().x(); }
  double lateral_error_mm() const { return placement().lateral_mm - tip().tail<2>().norm(); }
  double angle_error_deg() const {
    return placement().angle_deg -
           std::acos(std::min(frame.along.dot(c.needle.axis_S), 1.0)) * kDegreesPerRadian;
  }
  DepthVerdict verdict(double planned_mm) const {
    DepthCheckSettings with_plan = settings;
    with_plan.expected = Millimetres(planned_mm);
    return judge_depth(reading, with_plan).verdict;
  }
};

Read read(RescanCase c) {
  Read one;
  one.frame = needle_frame(c.after.grid, c.plan_p_SE, c.plan_axis_S);
  one.reading = read_depth(c.before, std::span(&c.after, 1), one.frame, one.settings.depth_max);
  // The painted void ends at the tip, but for what rounds it.
  one.settings.tip_offset =
      TipOffset{"painted", "rescan", Millimetres(c.needle.beyond_mm), Millimetres(0.15)};
  const Grid grid = c.after.grid;
  c.before = c.after = Volume{};  // of many cases there would be gigabytes
  c.after.grid = grid;
  one.c = std::move(c);
  return one;
}

std::vector<Read> read_all(const Pair& pair, Kind kind, std::uint64_t first, std::uint64_t count) {
  std::vector<Read> all;
  for (std::uint64_t seed = first; seed < first + count; ++seed)
    if (auto c = drawn(pair, kind, seed)) all.push_back(read(std::move(*c)));
  return all;
}

// Half a slice where slices are thicker than 2 mm.
double harm_mm(const Volume& after) {
  const double slice = after.grid.spacing_mm().maxCoeff();
  return slice > 2.0 ? 0.5 * slice : 1.0;
}

struct Tally {
  int count = 0, accepted = 0, rejected = 0, accepted_wrong = 0;

  void add(const Read& one, double planned_mm) {
    const DepthVerdict verdict = one.verdict(planned_mm);
    const bool accept = verdict == DepthVerdict::Accept;
    ++count;
    accepted += accept;
    rejected += verdict == DepthVerdict::Reject;
    accepted_wrong += accept && std::abs(one.depth_error_mm()) > harm_mm(one.c.after);
  }
  double accepted_share() const { return count > 0 ? static_cast<double>(accepted) / count : 0.0; }
  double rejected_share() const { return count > 0 ? static_cast<double>(rejected) / count : 0.0; }
};

Tally told(const Tally& tally, const Pair& pair, std::string_view what) {
  fmt::print("  {:12s} {:20s} accept {:3d}  reject {:3d}  unsure {:3d}  accepted and off {}\n", pair.name,
             what, tally.accepted, tally.rejected, tally.count - tally.accepted - tally.rejected,
             tally.accepted_wrong);
  return tally;
}

Tally of_kind(const Pair& pair, Kind kind, std::uint64_t count) {
  Tally tally;
  for (const Read& one : read_all(pair, kind, 101, count)) tally.add(one, one.c.plan_depth_mm);
  return told(tally, pair, label(kind));
}

// The same readings, had another depth been planned.
Tally of_depths(const Pair& pair, const std::vector<Read>& right, double off_mm) {
  Tally tally;
  for (const Read& one : right)
    for (const double off : {-off_mm, off_mm})
      if (one.c.plan_depth_mm + off >= 1.0) tally.add(one, one.c.plan_depth_mm + off);
  return told(tally, pair, fmt::format("depth wrong by {} mm", off_mm));
}

struct Counts {
  std::uint64_t right, wrong;  // cases of each kind
};

void expect_the_bar(const std::string& name, const Counts& counts, double accepted_least = 0.6) {
  const auto pair = real_pair(name);
  if (!pair) GTEST_SKIP() << "no real images beside the source folder";
  const std::vector<Read> readings = read_all(*pair, Kind::RightPlan, 101, counts.right);
  Tally right;
  for (const Read& one : readings) right.add(one, one.c.plan_depth_mm);
  told(right, *pair, label(Kind::RightPlan));
  EXPECT_GE(right.accepted_share(), accepted_least);
  EXPECT_EQ(right.accepted_wrong, 0);
  EXPECT_EQ(of_depths(*pair, readings, 3.0).accepted, 0);
  const Tally far = of_depths(*pair, readings, 8.0);
  EXPECT_EQ(far.accepted, 0);
  EXPECT_GE(far.rejected_share(), 0.7);
  EXPECT_EQ(of_kind(*pair, Kind::OldTrack, counts.wrong).accepted_wrong, 0);
  for (const Kind kind :
       {Kind::Beside5mm, Kind::Tilted6deg, Kind::NoNeedle, Kind::OtherPatient, Kind::Swapped})
    EXPECT_EQ(of_kind(*pair, kind, counts.wrong).accepted, 0) << label(kind);
}

TEST(RescanCheck, MeetsTheBarOnAFewNeedlesInARescan) {
  expect_the_bar("rescan", {10, 2});
}

TEST(RescanCampaign, MeetsTheBarInARescan) {
  expect_the_bar("rescan", {60, 12});
}

TEST(RescanCampaign, MeetsTheBarInTheRescanTakenTheOtherWay) {
  expect_the_bar("rescan_back", {60, 12});
}

TEST(RescanCampaign, MeetsTheBarInAnotherScannersRescan) {
  expect_the_bar("brain", {60, 12});
}

// Another sequence, resolution and day's position: fewer decisions, no wrong one.
TEST(RescanCampaign, NeverAcceptsWronglyBetweenPlanningAndGuidance) {
  expect_the_bar("planning", {40, 15}, 0.45);
}

// Of the needles that are seen, whatever the verdict: errors within one and two standard deviations.
TEST(RescanCampaign, StatesStandardDeviationsThatHold) {
  const auto pair = real_pair("rescan");
  if (!pair) GTEST_SKIP() << "no real images beside the source folder";
  int seen = 0;
  std::array<int, 3> within{};
  const auto count = [&](Kind kind, std::uint64_t cases) {
    for (const Read& one : read_all(*pair, kind, 301, cases)) {
      if (!one.seen()) continue;
      const NeedlePlacement placement = one.placement();
      ++seen;
      within[0] += std::abs(one.depth_error_mm()) < 2.0 * placement.depth_sigma_mm;
      // A length beside zero is read too large by about its standard deviation.
      within[1] += std::abs(one.lateral_error_mm()) < 2.5 * placement.lateral_sigma_mm + 0.1;
      within[2] += std::abs(one.angle_error_deg()) < 2.5 * placement.angle_sigma_deg + 0.1;
    }
  };
  count(Kind::RightPlan, 50), count(Kind::Beside5mm, 25), count(Kind::Tilted6deg, 25);
  fmt::print("  {} seen; within two standard deviations: depth {}, lateral {}, angle {}\n", seen, within[0],
             within[1], within[2]);
  for (int good : within) EXPECT_GE(good, 0.9 * seen);
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
