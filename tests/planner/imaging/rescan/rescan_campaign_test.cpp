// The depth check on pairs of real scans (../shared/data/images/mr), in which nothing but a needle painted by
// this test is known: verdicts by kind of error, and whether standard deviations mean what they say.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "planner/imaging/depth_check/depth_check.hpp"
#include "planner/imaging/io/read_volume.hpp"
#include "tests/expect_figures.hpp"
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

std::vector<std::string> row_of(const Tally& tally, std::string_view what) {
  return {fmt::format("{}, {}", what, tally.count), std::to_string(tally.accepted),
          std::to_string(tally.rejected), std::to_string(tally.count - tally.accepted - tally.rejected),
          std::to_string(tally.accepted_wrong)};
}

Tally as_planned(const std::vector<Read>& readings) {
  Tally tally;
  for (const Read& one : readings) tally.add(one, one.c.plan_depth_mm);
  return tally;
}

// The same readings, had another depth been planned.
Tally of_depths(const std::vector<Read>& readings, double off_mm) {
  Tally tally;
  for (const Read& one : readings)
    for (const double off : {-off_mm, off_mm})
      if (one.c.plan_depth_mm + off >= 1.0) tally.add(one, one.c.plan_depth_mm + off);
  return tally;
}

struct Counts {
  std::uint64_t right, wrong;  // cases of each kind
};

// The rows of its table in the documentation.
using Rows = std::vector<std::vector<std::string>>;

Rows expect_the_bar(const Pair& pair, const Counts& counts, double accepted_least = 0.6) {
  const std::vector<Read> readings = read_all(pair, Kind::RightPlan, 101, counts.right);
  const Tally right = as_planned(readings), near = of_depths(readings, 3.0), far = of_depths(readings, 8.0);
  EXPECT_GE(right.accepted_share(), accepted_least);
  EXPECT_EQ(right.accepted_wrong, 0);
  EXPECT_EQ(near.accepted, 0);
  EXPECT_EQ(far.accepted, 0);
  EXPECT_GE(far.rejected_share(), 0.7);
  Rows rows{row_of(right, label(Kind::RightPlan)), row_of(near, "depth wrong by 3 mm either way"),
            row_of(far, "depth wrong by 8 mm either way")};
  for (const Kind kind : {Kind::OldTrack, Kind::Beside5mm, Kind::Tilted6deg, Kind::NoNeedle,
                          Kind::OtherPatient, Kind::Swapped}) {
    const Tally tally = as_planned(read_all(pair, kind, 101, counts.wrong));
    EXPECT_EQ(kind == Kind::OldTrack ? tally.accepted_wrong : tally.accepted, 0) << label(kind);
    rows.push_back(row_of(tally, label(kind)));
  }
  return rows;
}

// A whole campaign, whose table is in docs/explanation/depth-check.md.
void expect_the_documented(const std::string& name, const Counts& counts, double accepted_least = 0.6) {
  const auto pair = real_pair(name);
  if (!pair) GTEST_SKIP() << "no real images beside the source folder";
  expect_figures("depth-check-" + name, {"build/dev/tests/test_imaging --gtest_filter='RescanCampaign.*'",
                                         "explanation/depth-check.md", opencv_in_use(),
                                         expect_the_bar(*pair, counts, accepted_least)});
}

TEST(RescanCheck, MeetsTheBarOnAFewNeedlesInARescan) {
  const auto pair = real_pair("rescan");
  if (!pair) GTEST_SKIP() << "no real images beside the source folder";
  expect_the_bar(*pair, {10, 2});
}

TEST(RescanCampaign, MeetsTheBarInARescan) {
  expect_the_documented("rescan", {60, 12});
}

TEST(RescanCampaign, MeetsTheBarInTheRescanTakenTheOtherWay) {
  expect_the_documented("rescan_back", {60, 12});
}

TEST(RescanCampaign, MeetsTheBarInAnotherScannersRescan) {
  expect_the_documented("brain", {60, 12});
}

// Another sequence, resolution and day's position: fewer decisions, no wrong one.
TEST(RescanCampaign, NeverAcceptsWronglyBetweenPlanningAndGuidance) {
  expect_the_documented("planning", {40, 15}, 0.45);
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
  expect_figures("depth-check-deviations",
                 {"build/dev/tests/test_imaging --gtest_filter='RescanCampaign.*'",
                  "explanation/depth-check.md",
                  opencv_in_use(),
                  {{fmt::format("re-scan, {} needles seen", seen), std::to_string(within[0]),
                    std::to_string(within[1]), std::to_string(within[2])}}});
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
