// A titanium needle whose artefact is computed from its field (sim/scanner/susceptibility, which shares
// nothing with the depth check), in one of two real scans: its void ends beyond the tip by what only a
// calibration tells.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "planner/imaging/depth_check/depth_check.hpp"
#include "robot/common/statistics.hpp"
#include "sim/scanner/scanner.hpp"
#include "tests/expect_figures.hpp"
#include "tests/planner/imaging/rescan/rescan_case.hpp"

namespace biopsy::imaging::rescan {
namespace {

Volume with_titanium(const Volume& scan, const PaintedNeedle& needle) {
  sim::ScanSettings settings;
  settings.body = sim::NeedleBody{};
  settings.body->p_ST = needle.p_SE + needle.tip_mm * needle.axis_S;
  settings.body->p_SE = settings.body->p_ST - needle.axis_S;
  settings.drift = 0.0, settings.snr = 0.0;  // the scan has its own
  return sim::scan(scan, settings);
}

// Nearly across the field, as a transverse needle lies.
std::vector<RescanCase> transverse_needles(const Pair& pair, std::size_t count) {
  std::vector<RescanCase> cases;
  for (std::uint64_t seed = 1; seed < 200 && cases.size() < count; ++seed) {
    auto c = drawn(pair, Kind::RightPlan, seed);
    if (c && std::abs(c->needle.axis_S.x()) > 0.9) cases.push_back(std::move(*c));
  }
  return cases;
}

TEST(RescanCampaign, ReadsAPhysicalNeedleByItsCalibrationAndAcceptsNoneWithout) {
  const auto pair = real_pair("rescan");
  if (!pair) GTEST_SKIP() << "no real images beside the source folder";
  const std::vector<RescanCase> cases = transverse_needles(*pair, 14);
  ASSERT_EQ(cases.size(), 14u);
  std::vector<double> offsets;
  int accepted = 0, rejected = 0;
  for (std::size_t n = 0; n < cases.size(); ++n) {
    const RescanCase& c = cases[n];
    const Volume after = with_titanium(pair->after, c.needle);
    DepthCheckSettings settings;
    settings.expected = Millimetres(c.plan_depth_mm);
    const DepthCheck bare = check_depth(c.before, after, c.plan_p_SE, c.plan_axis_S, settings);
    EXPECT_NE(bare.verdict, DepthVerdict::Accept) << bare.reason;
    if (n < 6) {  // of these the depth is taken as known
      if (bare.tip_found) offsets.push_back(bare.depth.value - c.needle.tip_mm);
      continue;
    }
    settings.tip_offset = TipOffset{"titanium 18 G", "gradient echo", Millimetres(mean(offsets)),
                                    Millimetres(std::max(standard_deviation(offsets), 0.1) *
                                                std::sqrt(1.0 + 1.0 / static_cast<double>(offsets.size())))};
    const DepthCheck check = check_depth(c.before, after, c.plan_p_SE, c.plan_axis_S, settings);
    accepted += check.verdict == DepthVerdict::Accept;
    rejected += check.verdict == DepthVerdict::Reject;
    const double off_mm = std::abs(check.depth.value - c.needle.tip_mm);
    EXPECT_FALSE(check.verdict == DepthVerdict::Accept && off_mm > 1.0) << check.reason;
    EXPECT_FALSE(check.tip_found && check.sigma.value < 1.0 && off_mm > 2.0) << check.reason;
  }
  expect_figures("depth-check-titanium",
                 {"build/dev/tests/test_imaging --gtest_filter='RescanCampaign.*'",
                  "explanation/depth-check.md",
                  opencv_in_use(),
                  {{"18 G titanium, nearly across the field", fmt::format("{:.2f}", mean(offsets)),
                    fmt::format("{:.2f}", standard_deviation(offsets)), fmt::format("{} of 8", accepted),
                    std::to_string(rejected)}}});
  EXPECT_GT(mean(offsets), 0.5);  // a bulb beyond the tip, as in life
  EXPECT_GE(accepted, 4);
}

}  // namespace
}  // namespace biopsy::imaging::rescan
