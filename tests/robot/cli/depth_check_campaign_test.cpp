// Hundreds of confirmation images with known needle depth, rendered into real volumes, read by the depth
// check. A quarter of them, or all with WHOLE_CAMPAIGNS in the environment (./dev campaigns).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <optional>

#include "planner/imaging/depth_check/depth_check.hpp"
#include "planner/imaging/io/read_volume.hpp"
#include "sim/plant/seeded_noise.hpp"
#include "sim/scanner/phantom.hpp"
#include "sim/scanner/scanner.hpp"
#include "tests/source_dir.hpp"

namespace biopsy {
namespace {

// What is drawn at random for one set of volumes.
struct Draw {
  double radius_min_mm, radius_max_mm;  // of the void
  double depth_min_mm, depth_max_mm;
  double snr_min = 15.0, snr_max = 35.0;
  bool needle = true;
  bool adversarial = false;    // old track and bubbles in both images, ghosting, lower signal
  bool bubble_at_tip = false;  // one of the bubbles, so that the tissue about the tip is dark in both images
};

struct Case {
  Point p_SE;
  Direction axis_S;
  double depth_mm = 0.0;
  sim::ScanSettings before, after;
};

Eigen::Vector3d random_direction(std::uint64_t seed, std::uint64_t counter) {
  const sim::NormalPair a = sim::normals(seed, counter), b = sim::normals(seed, counter + 1);
  return Eigen::Vector3d(a.first, a.second, b.first).normalized();
}

double between(double low, double high, std::uint64_t seed, std::uint64_t counter) {
  return low + (high - low) * sim::uniform(seed, counter);
}

// A needle path is drawn until it runs through tissue: in air no image shows a needle.
bool runs_through_tissue(const imaging::Sampler& sampler, const Case& c, double tissue) {
  int bright = 0, count = 0;
  for (double t = -3.0; t <= c.depth_mm + 8.0; t += 1.0, ++count) {
    const double value = sampler.at(c.p_SE + t * c.axis_S);
    if (std::isnan(value)) return false;
    bright += value > 0.35 * tissue;
  }
  for (double t = c.depth_mm - 3.0; t <= c.depth_mm + 3.0; t += 0.5)
    if (!(sampler.at(c.p_SE + t * c.axis_S) > 0.4 * tissue)) return false;
  return bright >= 0.85 * count;
}

// The needle strays from the expected axis by up to 1.5 mm and 1.5 degrees.
sim::NeedleArtefact strayed_needle(const Case& c, const imaging::NeedleFrame& frame, const Draw& draw,
                                   std::uint64_t key) {
  const double pi = std::numbers::pi;
  const double aside = between(0.0, 1.5, key, 27), towards = between(0.0, 2.0 * pi, key, 28);
  const double tilt = std::tan(between(0.0, 1.5, key, 29) * pi / 180.0),
               about = between(0.0, 2.0 * pi, key, 40);
  sim::NeedleArtefact needle;
  needle.p_SE = c.p_SE + aside * (std::cos(towards) * frame.across + std::sin(towards) * frame.up);
  needle.axis_S =
      (c.axis_S + tilt * (std::cos(about) * frame.across + std::sin(about) * frame.up)).normalized();
  needle.tip_depth = Millimetres(c.depth_mm / needle.axis_S.dot(c.axis_S));
  needle.radius = Millimetres(draw.radius_min_mm *
                              std::pow(draw.radius_max_mm / draw.radius_min_mm, sim::uniform(key, 23)));
  needle.edge = Millimetres(0.15 + 0.2 * needle.radius.value * sim::uniform(key, 24));
  needle.tip_roundness = sim::uniform(key, 25);
  needle.tip_bloom = 0.4 * sim::uniform(key, 26);
  return needle;
}

void add_traces(Case& c, const imaging::NeedleFrame& frame, const Draw& draw, int rows, std::uint64_t key) {
  const double beside = between(4.0, 8.0, key, 60), towards = between(0.0, 6.28, key, 61);
  const Eigen::Vector3d aside = beside * (std::cos(towards) * frame.across + std::sin(towards) * frame.up);
  std::vector<sim::TissueVoid> voids{
      {c.p_SE - 10.0 * c.axis_S + aside,
       c.p_SE + between(c.depth_mm - 3.0, c.depth_mm + 7.0, key, 62) * c.axis_S + aside, Millimetres(1.0),
       Millimetres(0.4), 0.7}};
  for (std::uint64_t n = 0; n < 4; ++n) {
    const bool at_tip = draw.bubble_at_tip && n == 0;
    const double along_mm = at_tip ? between(c.depth_mm - 1.0, c.depth_mm + 3.0, key, 70)
                                   : between(0.0, 1.3 * c.depth_mm, key, 70 + n);
    const Point bubble = c.p_SE + along_mm * c.axis_S +
                         between(0.0, at_tip ? 1.5 : 5.0, key, 95 + n) * random_direction(key, 80 + 3 * n);
    voids.push_back({bubble, bubble, Millimetres(between(1.0, 3.0, key, 100 + n)), Millimetres(0.4), 0.9});
  }
  c.before.voids = c.after.voids = voids;
  c.before.snr = 25.0, c.before.drift = 0.0, c.before.seed = key ^ 77u;
  c.after.ghost = between(0.0, 0.12, key, 63);
  c.after.ghost_shift_voxels = static_cast<int>(rows * between(0.2, 0.5, key, 64));
  c.after.snr = between(10.0, 20.0, key, 65);
}

std::optional<Case> drawn_case(const Volume& planning, double tissue, const Draw& draw, std::uint64_t seed) {
  const imaging::Sampler sampler(planning);
  for (std::uint64_t attempt = 0; attempt < 20000; ++attempt) {
    const std::uint64_t key = seed * 1000003u + attempt * 17u;
    Case c;
    Eigen::Vector3d index;
    for (int a = 0; a < 3; ++a)
      index[a] = between(0.0, planning.grid.size[a] - 1.0, key, static_cast<std::uint64_t>(a));
    c.p_SE = planning.grid.X_SI * index;
    c.axis_S = random_direction(key, 5);
    c.depth_mm = between(draw.depth_min_mm, draw.depth_max_mm, key, 9);
    if (!runs_through_tissue(sampler, c, tissue)) continue;
    const imaging::NeedleFrame frame = imaging::needle_frame(planning.grid, c.p_SE, c.axis_S);
    c.after.seed = key;
    c.after.snr = between(draw.snr_min, draw.snr_max, key, 20);
    c.after.drift = 0.15;
    c.after.motion = {c.p_SE, between(0.0, 5.0, key, 21) * random_direction(key, 30),
                      between(0.0, 5.0, key, 22) * random_direction(key, 34)};
    if (draw.needle) c.after.needle = strayed_needle(c, frame, draw, key);
    if (draw.adversarial) add_traces(c, frame, draw, 100, key);
    return c;
  }
  return std::nullopt;
}

// The painted void ends at the tip.
imaging::DepthCheckSettings of_painted_void() {
  imaging::DepthCheckSettings settings;
  settings.tip_offset = TipOffset{"painted void", kSimulatedSequence, Millimetres(0.0), Millimetres(0.05)};
  return settings;
}

struct Outcome {
  DepthCheck check;
  double depth_mm, error_mm;
};

// Only the part of the volume about the path is rendered: the check looks at no more.
Outcome read_rendering(const Volume& planning, const Case& c, const Draw& draw) {
  imaging::Box box{c.p_SE, c.p_SE};
  box.include(c.p_SE - 15.0 * c.axis_S, 48.0);
  box.include(c.p_SE + c.depth_mm * c.axis_S, 55.0);
  const Volume part = imaging::cropped(planning, box);
  const Volume before = draw.adversarial ? sim::scan(part, c.before) : part;
  const DepthCheck check =
      imaging::check_depth(before, sim::scan(part, c.after), c.p_SE, c.axis_S, of_painted_void());
  return {check, c.depth_mm, check.depth.value - c.depth_mm};
}

// How many of a campaign's images are read now.
std::uint64_t read_of(std::uint64_t whole) {
  return std::getenv("WHOLE_CAMPAIGNS") == nullptr ? whole / 4 : whole;
}

std::vector<Outcome> campaign(const Volume& planning, const Draw& draw, std::uint64_t whole,
                              std::uint64_t first = 1) {
  const double tissue = sim::tissue_signal(planning);
  std::vector<Outcome> outcomes;
  for (std::uint64_t seed = first; seed < first + read_of(whole); ++seed)
    if (const auto c = drawn_case(planning, tissue, draw, seed))
      outcomes.push_back(read_rendering(planning, *c, draw));
  return outcomes;
}

double share(const std::vector<Outcome>& outcomes, const auto& holds) {
  return static_cast<double>(std::count_if(outcomes.begin(), outcomes.end(), holds)) /
         static_cast<double>(outcomes.size());
}

bool within(const Outcome& o, double band_mm) {
  return o.check.tip_found && std::abs(o.error_mm) <= band_mm;
}

void expect_no_wrong_accept(const std::vector<Outcome>& outcomes, double most_mm = 1.0) {
  for (const Outcome& o : outcomes) {
    if (o.check.verdict != DepthVerdict::Accept) continue;
    EXPECT_LE(std::abs(o.error_mm), most_mm) << "at " << o.depth_mm << " mm: " << o.check.reason;
  }
}

// 95 % within 0.4 mm or half a pixel; no accepted depth wrong by more than 1 mm; sigmas that mean what they
// say.
void expect_the_bar(const std::vector<Outcome>& outcomes, double band_mm, double accepted_min) {
  EXPECT_GE(share(outcomes, [&](const Outcome& o) { return within(o, band_mm); }), 0.95);
  expect_no_wrong_accept(outcomes);
  EXPECT_GE(share(outcomes,
                  [](const Outcome& o) {
                    return o.check.tip_found && std::abs(o.error_mm) < 3.0 * o.check.sigma.value;
                  }),
            0.95);
  EXPECT_GE(share(outcomes, [](const Outcome& o) { return o.check.verdict == DepthVerdict::Accept; }),
            accepted_min);
}

std::optional<Volume> real_volume(const std::string& name) {
  const auto path = source_dir() / "../shared/data/images/mr" / name;
  if (!std::filesystem::exists(path)) return std::nullopt;
  return imaging::read_volume(path);
}

// A real volume as a fast sequence for guidance would show it.
Volume coarse(const Volume& planning) {
  const Eigen::Vector3d wanted(1.2, 1.2, 3.6), factor = wanted.cwiseQuotient(planning.grid.spacing_mm());
  sim::ScanSettings settings;
  settings.snr = 20.0, settings.drift = 0.0;
  settings.grid = planning.grid;
  settings.grid->X_SI.linear() = planning.grid.X_SI.linear() * factor.asDiagonal();
  settings.grid->size = planning.grid.size.cast<double>().cwiseQuotient(factor).cast<int>();
  return sim::scan(planning, settings);
}

constexpr Draw kProstate{0.75, 3.0, 4.0, 45.0};
constexpr Draw kLiver{1.5, 5.0, 4.0, 45.0};
constexpr Draw kCoarse{1.8, 6.0, 4.0, 45.0};

TEST(DepthCheckCampaign, MeetsTheBarOnARealProstate) {
  const auto planning = real_volume("prostate_planning");
  if (!planning) GTEST_SKIP() << "no real images beside the source folder";
  // Four in 150 are off, on one processor's vector instructions or another's: of a quarter of 150, two may
  // be.
  expect_the_bar(campaign(*planning, kProstate, 300), 0.4, 0.5);
}

TEST(DepthCheckCampaign, MeetsTheBarOnARealLiver) {
  const auto planning = real_volume("liver/example_mr_sm.nii.gz");
  if (!planning) GTEST_SKIP() << "no real images beside the source folder";
  expect_the_bar(campaign(*planning, kLiver, 150), 1.5,
                 0.0);  // 3 mm voxels seldom settle 1 mm: unsure is right
}

TEST(DepthCheckCampaign, NeverAcceptsWhereThereIsNoNeedle) {
  const auto planning = real_volume("prostate_planning"), liver = real_volume("liver/example_mr_sm.nii.gz");
  if (!planning || !liver) GTEST_SKIP() << "no real images beside the source folder";
  Draw empty = kProstate, spoiled = kCoarse;
  empty.needle = spoiled.needle = false;
  spoiled.adversarial = true;
  const auto accepts = [](const Outcome& o) { return o.check.verdict == DepthVerdict::Accept; };
  EXPECT_EQ(share(campaign(*planning, empty, 60), accepts), 0.0);
  EXPECT_EQ(share(campaign(*liver, empty, 60), accepts), 0.0);
  EXPECT_EQ(share(campaign(coarse(*planning), spoiled, 60), accepts), 0.0);
}

TEST(DepthCheckCampaign, SurvivesOldTracksBubblesAndGhostsInCoarseVoxels) {
  const auto planning = real_volume("prostate_planning");
  if (!planning) GTEST_SKIP() << "no real images beside the source folder";
  Draw draw = kCoarse;
  draw.adversarial = true;
  const auto outcomes = campaign(coarse(*planning), draw, 100);
  EXPECT_GE(share(outcomes, [](const Outcome& o) { return within(o, 0.6); }), 0.85);
  expect_no_wrong_accept(outcomes);
}

// Where neither image shows tissue, nothing says where the needle ends. A noise model without the error of
// interpolation accepted two of the first 40 needles, wrong by 2.0 and 2.2 mm.
TEST(DepthCheckCampaign, AcceptsNoWrongDepthWhereABubbleTouchesTheTip) {
  const auto planning = real_volume("prostate_planning");
  if (!planning) GTEST_SKIP() << "no real images beside the source folder";
  Draw draw = kCoarse;
  draw.adversarial = draw.bubble_at_tip = true;
  constexpr double kHalfSlice_mm = 1.8;
  expect_no_wrong_accept(campaign(coarse(*planning), draw, 160, 61), kHalfSlice_mm);
}

TEST(DepthCheckCampaign, NeverAcceptsARealGuidanceScanWithoutNeedle) {
  const auto planning = real_volume("prostate_planning"), guidance = real_volume("prostate_guidance");
  if (!planning || !guidance) GTEST_SKIP() << "no real images beside the source folder";
  for (std::uint64_t n = 0; n < read_of(30); ++n) {
    const Point p_SE = Point(6, -27, 52) + 10.0 * random_direction(n, 1);
    const DepthCheck check =
        imaging::check_depth(*planning, *guidance, p_SE, random_direction(n, 5), of_painted_void());
    EXPECT_NE(check.verdict, DepthVerdict::Accept) << check.reason;
  }
}

TEST(DepthCheckCampaign, ReadsThePapersDepthsOnItsPhantomToATenthOfAMillimetre) {
  const sim::Phantom phantom = sim::paper_phantom();
  std::uint64_t seed = 1;
  for (double depth : {2.0, 2.5, 3.5, 5.0}) {
    sim::ScanSettings settings;
    settings.needle = sim::NeedleArtefact{phantom.p_SE, phantom.axis_S, Millimetres(depth)};
    settings.motion = {phantom.p_SE, 2.0 * random_direction(seed, 1), 2.0 * random_direction(seed, 4)};
    settings.seed = seed++;
    const DepthCheck check = imaging::check_depth(phantom.image, sim::scan(phantom.image, settings),
                                                  phantom.p_SE, phantom.axis_S, of_painted_void());
    EXPECT_EQ(check.verdict, DepthVerdict::Accept) << check.reason;
    EXPECT_NEAR(check.depth.value, depth, 0.1);
  }
}

TEST(DepthCheckCampaign, NeverAcceptsAnEmptyPhantom) {
  const sim::Phantom phantom = sim::paper_phantom({.voxel = Millimetres(0.5)});
  for (std::uint64_t seed = 1; seed <= read_of(20); ++seed) {
    sim::ScanSettings settings;
    settings.motion = {phantom.p_SE, 4.0 * random_direction(seed, 1), 4.0 * random_direction(seed, 4)};
    settings.seed = seed;
    settings.snr = 15.0;
    const DepthCheck check = imaging::check_depth(phantom.image, sim::scan(phantom.image, settings),
                                                  phantom.p_SE, phantom.axis_S, of_painted_void());
    EXPECT_NE(check.verdict, DepthVerdict::Accept) << check.reason;
  }
}

}  // namespace
}  // namespace biopsy
