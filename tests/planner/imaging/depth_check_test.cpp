#include "planner/imaging/depth_check/depth_check.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "robot/common/config_error.hpp"
#include "tests/planner/imaging/analytic_scene.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::imaging {
namespace {

Volume before() {
  return scene::imaged(scene::grid(0.8, 2.4), [](const Point& p) { return scene::tissue(p); });
}

// The patient moved by `shift`; the needle stays on its axis in the scanner.
Volume after(double depth, double loss = 0.95, double noise = 15.0,
             const Eigen::Vector3d& shift = {1.0, -2.0, 1.5}) {
  return scene::imaged(scene::grid(0.8, 2.4), [&](const Point& p) {
    return std::abs(scene::tissue(p - shift) *
                        scene::left_by_needle(p, scene::kEntry, scene::kAxis, depth, 2.0, loss) +
                    noise * scene::grain(p));
  });
}

DepthCheckSettings calibrated() {
  DepthCheckSettings settings;
  settings.tip_offset = TipOffset{"scene", "scene", Millimetres(0.0), Millimetres(0.05)};
  return settings;
}

DepthCheckSettings expecting(double depth) {
  DepthCheckSettings settings = calibrated();
  settings.expected = Millimetres(depth);
  return settings;
}

TEST(DepthCheck, AcceptsATipWhereItWasPlannedAndTellsHowThePatientMoved) {
  const DepthCheck check = check_depth(before(), after(20.0), scene::kEntry, scene::kAxis, expecting(20.1));
  EXPECT_EQ(check.verdict, DepthVerdict::Accept) << check.reason;
  EXPECT_NEAR(check.depth.value, 20.0, 0.3);
  EXPECT_NEAR(check.shift_mm[0], 1.0, 0.2);
  EXPECT_NEAR(check.shift_mm[1], -2.0, 0.2);
  EXPECT_NEAR(check.shift_mm[2], 1.5, 0.2);
}

TEST(DepthCheck, RejectsATipElsewhereAndSaysOnWhichSide) {
  const DepthCheck deep = check_depth(before(), after(20.0), scene::kEntry, scene::kAxis, expecting(17.0));
  EXPECT_EQ(deep.verdict, DepthVerdict::Reject);
  EXPECT_NE(deep.reason.find("deeper than"), std::string::npos) << deep.reason;
  const DepthCheck shallow = check_depth(before(), after(20.0), scene::kEntry, scene::kAxis, expecting(23.0));
  EXPECT_EQ(shallow.verdict, DepthVerdict::Reject);
  EXPECT_NE(shallow.reason.find("short of"), std::string::npos) << shallow.reason;
}

TEST(DepthCheck, ReadsTheSameDepthWhateverWasPlanned) {
  const Volume first = before(), second = after(20.0);
  const DepthCheck free = check_depth(first, second, scene::kEntry, scene::kAxis, calibrated());
  for (double planned : {5.0, 19.5, 40.0}) {
    const DepthCheck check = check_depth(first, second, scene::kEntry, scene::kAxis, expecting(planned));
    EXPECT_EQ(check.depth.value, free.depth.value);
    EXPECT_EQ(check.sigma.value, free.sigma.value);
  }
}

TEST(DepthCheck, RejectsWhenNoNeedleIsThereAndIsUnsureWhenNoiseHidesEverything) {
  EXPECT_EQ(check_depth(before(), after(20.0, 0.0), scene::kEntry, scene::kAxis, calibrated()).verdict,
            DepthVerdict::Reject);
  const DepthCheck noisy =
      check_depth(before(), after(20.0, 0.0, 250.0), scene::kEntry, scene::kAxis, calibrated());
  EXPECT_EQ(noisy.verdict, DepthVerdict::Unsure) << noisy.reason;
}

TEST(DepthCheck, NeverAcceptsImagesOfDifferentTissue) {
  verifies("R-60");
  const Volume other = scene::imaged(scene::grid(0.8, 2.4), [](const Point& p) {
    return scene::tissue(Point(-p.y() + 9.0, p.z(), p.x())) *
           scene::left_by_needle(p, scene::kEntry, scene::kAxis, 20.0, 2.0);
  });
  const DepthCheck check = check_depth(before(), other, scene::kEntry, scene::kAxis, calibrated());
  EXPECT_EQ(check.verdict, DepthVerdict::Unsure) << check.reason;
}

TEST(DepthCheck, IsUnsureWhenTheTipLeavesTheImage) {
  const DepthCheck check = check_depth(before(), after(300.0), scene::kEntry, scene::kAxis, calibrated());
  EXPECT_EQ(check.verdict, DepthVerdict::Unsure) << check.reason;
}

TEST(DepthCheck, TakesOffTheCalibratedTipOffset) {
  DepthCheckSettings settings;
  const Volume first = before(), second = after(20.0);
  const double plain = check_depth(first, second, scene::kEntry, scene::kAxis, settings).depth.value;
  settings.tip_offset = TipOffset{"scene", "scene", Millimetres(0.7), Millimetres(0.3)};
  EXPECT_NEAR(check_depth(first, second, scene::kEntry, scene::kAxis, settings).depth.value, plain - 0.7,
              1e-12);
}

TEST(DepthCheck, DrawsBothImagesInOnePlaneWithTheTipMarked) {
  DepthCheckPictures pictures;
  check_depth(before(), after(20.0), scene::kEntry, scene::kAxis, {}, &pictures);
  ASSERT_EQ(pictures.before.picture.rgb.size(), pictures.after.picture.rgb.size());
  EXPECT_EQ(pictures.before.mm_per_pixel, pictures.after.mm_per_pixel);
  EXPECT_LT((pictures.tip_px - pictures.after.pixel(20.0, 0.0)).norm() * pictures.after.mm_per_pixel, 0.7);
  int coloured = 0;
  for (std::size_t n = 0; n < pictures.after.picture.rgb.size(); n += 3)
    coloured += pictures.after.picture.rgb[n] != pictures.after.picture.rgb[n + 2];
  EXPECT_GT(coloured, 20);
  // Registered: away from the needle both show the same tissue.
  double difference = 0.0;
  int count = 0;
  for (int x = 150; x < 360; ++x)
    for (int y = 320; y < 400; ++y, ++count)
      difference += std::abs(pictures.after.picture.rgb[static_cast<std::size_t>(3 * (y * 512 + x))] -
                             pictures.before.picture.rgb[static_cast<std::size_t>(3 * (y * 512 + x))]);
  EXPECT_LT(difference / count, 16.0);
}

TEST(DepthCheck, RefusesAnAxisWithoutLengthAnEmptyImageAndAnEntryOutsideBoth) {
  const Volume image = before();
  EXPECT_THROW(check_depth(image, image, scene::kEntry, Direction::Zero()), ConfigError);
  EXPECT_THROW(check_depth(image, Volume{}, scene::kEntry, scene::kAxis), ConfigError);
  EXPECT_THROW(check_depth(image, image, Point(500.0, 0.0, 0.0), scene::kAxis), ConfigError);
}

TEST(DepthCheck, AcceptsNothingWithoutACalibrationOfTheTip) {
  verifies("R-60");
  DepthCheckSettings settings = expecting(20.0);
  settings.tip_offset.reset();
  const DepthCheck check = check_depth(before(), after(20.0), scene::kEntry, scene::kAxis, settings);
  EXPECT_EQ(check.verdict, DepthVerdict::Unsure);
  EXPECT_NE(check.reason.find("calibrated"), std::string::npos) << check.reason;
  EXPECT_FALSE(check.tip_offset_known);
}

TEST(DepthCheck, RejectsANeedleBesideOrTiltedAgainstThePlannedAxis) {
  verifies("R-60");
  const Volume first = before(), second = after(20.0);
  const NeedleFrame frame = needle_frame(first.grid, scene::kEntry, scene::kAxis);
  const DepthCheck beside =
      check_depth(first, second, frame.point(0.0, 4.0, -3.0), scene::kAxis, expecting(20.0));
  EXPECT_EQ(beside.verdict, DepthVerdict::Reject) << beside.reason;
  EXPECT_NEAR(beside.lateral_mm, 5.0, 0.4);
  const Direction tilted = (scene::kAxis + std::tan(6.0 / 57.29578) * frame.up).normalized();
  const DepthCheck tilt = check_depth(first, second, scene::kEntry, tilted, expecting(20.0));
  EXPECT_EQ(tilt.verdict, DepthVerdict::Reject) << tilt.reason;
  EXPECT_NEAR(tilt.angle_deg, 6.0, 1.0);
}

// A reading that is accepted: each quantity sharp and where it was planned.
DepthReading good_reading() {
  DepthReading good;
  good.motion.within_limits = true;
  good.motion.score = 0.95;
  good.motion.points = 10000;
  good.tip.evidence = 50.0, good.tip.visible = 30.0, good.tip.loss = 0.9, good.tip.loss_sigma = 0.02;
  good.tip.control_places = 100, good.tip.seen_to_mm = 60.0;
  good.tip.beside_mm.covariance = 0.01 * Eigen::Matrix2d::Identity();
  good.tip.slope.covariance = 1e-5 * Eigen::Matrix2d::Identity();
  return good;
}

void spread_depth(TipFinding& tip, double depth, double sigma) {
  tip.depth_mm = depth, tip.sigma_mm = sigma;
  tip.depths_mm.clear(), tip.weights.clear();
  double total = 0.0;
  for (double d = 0.0; d < 60.0; d += 0.1) {
    tip.depths_mm.push_back(d);
    tip.weights.push_back(std::exp(-0.5 * std::pow((d - depth) / sigma, 2)));
    total += tip.weights.back();
  }
  for (double& weight : tip.weights) weight /= total;
}

TEST(JudgeDepth, NamesTheQuantityThatIsUncertainOrMisses) {
  verifies("R-60");
  const DepthCheckSettings settings = expecting(20.0);
  const auto judged = [&](const auto& corrupt) {
    DepthReading reading = good_reading();
    spread_depth(reading.tip, 20.1, 0.15);
    corrupt(reading);
    return judge_depth(reading, settings);
  };
  const auto verdict_after = [&](const auto& corrupt) { return judged(corrupt).verdict; };
  ASSERT_EQ(verdict_after([](DepthReading&) {}), DepthVerdict::Accept);
  EXPECT_EQ(verdict_after([](DepthReading& r) { r.tip.gap_mm = 3.0; }), DepthVerdict::Unsure);
  EXPECT_EQ(verdict_after([](DepthReading& r) { r.tip.at_end = true; }), DepthVerdict::Reject);
  EXPECT_EQ(verdict_after([](DepthReading& r) { r.tip.at_end = true, r.tip.seen_to_mm = 20.2; }),
            DepthVerdict::Unsure);
  EXPECT_EQ(verdict_after([](DepthReading& r) { spread_depth(r.tip, 20.0, 0.8); }), DepthVerdict::Unsure);
  EXPECT_EQ(verdict_after([](DepthReading& r) { spread_depth(r.tip, 20.7, 0.15); }), DepthVerdict::Unsure);
  EXPECT_EQ(verdict_after([](DepthReading& r) { spread_depth(r.tip, 21.5, 0.15); }), DepthVerdict::Reject);
  EXPECT_EQ(verdict_after([](DepthReading& r) { r.tip.beside_mm.value = {1.9, 2.0}; }), DepthVerdict::Reject);
  EXPECT_EQ(verdict_after([](DepthReading& r) { r.tip.beside_mm.covariance *= 400.0; }),
            DepthVerdict::Unsure);
  EXPECT_EQ(verdict_after([](DepthReading& r) { r.tip.slope.value = {0.06, 0.0}; }), DepthVerdict::Reject);
  EXPECT_EQ(verdict_after([](DepthReading& r) { r.tip.slope.covariance *= 400.0; }), DepthVerdict::Unsure);
  EXPECT_EQ(verdict_after([](DepthReading& r) { r.motion.score = 0.3; }), DepthVerdict::Unsure);
  EXPECT_EQ(verdict_after([](DepthReading& r) { r.motion.within_limits = false; }), DepthVerdict::Unsure);
  EXPECT_EQ(verdict_after([](DepthReading& r) { r.tip.control_places = 0; }), DepthVerdict::Unsure);
  EXPECT_EQ(verdict_after([](DepthReading& r) { r.tip.loss = 0.1; }), DepthVerdict::Reject);
  EXPECT_EQ(verdict_after([](DepthReading& r) { r.tip.loss = 0.1, r.tip.visible = 1.0; }),
            DepthVerdict::Unsure);
  EXPECT_NE(verdict_after([](DepthReading& r) { r.tip.sigma_mm = r.tip.depth_mm = NAN; }),
            DepthVerdict::Accept);
  EXPECT_NE(verdict_after([](DepthReading& r) { r.tip.evidence = NAN; }), DepthVerdict::Accept);
  EXPECT_NE(verdict_after([](DepthReading& r) { r.tip.beside_mm.value.x() = NAN; }), DepthVerdict::Accept);
  EXPECT_NE(verdict_after([](DepthReading& r) { r.tip.slope.covariance(0, 0) = NAN; }), DepthVerdict::Accept);
  EXPECT_NE(verdict_after([](DepthReading& r) { r.motion.score = NAN; }), DepthVerdict::Accept);
  EXPECT_EQ(judge_depth({}, settings).verdict, DepthVerdict::Unsure);
  EXPECT_NE(judged([](DepthReading& r) {
              r.tip.beside_mm.value = {2.6, 1.0};
            }).reason.find("beside"),
            std::string::npos);
}

// Of a quantity that is hardly known every narrow band holds little probability: that is no miss.
TEST(JudgeDepth, DoesNotRejectForWhatIsHardlyKnown) {
  const DepthCheckSettings settings = expecting(20.0);
  DepthReading reading = good_reading();
  spread_depth(reading.tip, 20.1, 0.15);
  const Eigen::Matrix2d known = reading.tip.beside_mm.covariance;
  reading.tip.beside_mm.covariance(1, 1) = 1e6;  // one slice: nothing is told across it
  EXPECT_EQ(judge_depth(reading, settings).verdict, DepthVerdict::Unsure);
  reading.tip.beside_mm.value.x() = 5.0;  // and within it the needle misses
  EXPECT_EQ(judge_depth(reading, settings).verdict, DepthVerdict::Reject);
  reading.tip.beside_mm = {Eigen::Vector2d::Zero(), known};
  reading.tip.slope.covariance = 1e4 * Eigen::Matrix2d::Identity();
  EXPECT_EQ(judge_depth(reading, settings).verdict, DepthVerdict::Unsure);
  // Tilted by 5 degrees to one side of a slice, or to the other, or not at all.
  reading.tip.slope = {{0.09, 0.0}, 1e-5 * Eigen::Matrix2d::Identity(), {-0.18, 0.0}};
  EXPECT_EQ(judge_depth(reading, settings).verdict, DepthVerdict::Unsure);
  // By a degree to either: an accept holds for both.
  reading.tip.slope = {{0.018, 0.0}, 1e-5 * Eigen::Matrix2d::Identity(), {-0.036, 0.0}};
  EXPECT_EQ(judge_depth(reading, settings).verdict, DepthVerdict::Accept);
  reading = good_reading();  // into air: the tip may be anywhere from 15 mm on
  spread_depth(reading.tip, 20.0, 1e6);
  reading.tip.depth_mm = 15.0, reading.tip.depths_mm.clear(), reading.tip.weights.clear();
  for (double d = 0.0; d < 150.0; d += 0.1) {
    reading.tip.depths_mm.push_back(d);
    reading.tip.weights.push_back(d < 15.0 ? 0.0 : 1.0 / 1350.0);
  }
  EXPECT_EQ(judge_depth(reading, settings).verdict, DepthVerdict::Unsure);
  DepthCheckSettings shallow = expecting(10.0);
  EXPECT_EQ(judge_depth(reading, shallow).verdict, DepthVerdict::Reject);
}

// Across a slice thicker than the void the needle's line is not known: it may leave the slice before its tip.
TEST(JudgeDepth, TakesNoDepthFromAVoidWhoseLineIsNotKnown) {
  DepthReading reading = good_reading();
  spread_depth(reading.tip, 12.0, 0.3);  // planned: 20 mm
  ASSERT_EQ(judge_depth(reading, expecting(20.0)).verdict, DepthVerdict::Reject);
  for (const bool two_sides : {false, true}) {
    Planar& place = reading.tip.beside_mm;
    place = {{0.2, 0.0}, 0.01 * Eigen::Matrix2d::Identity()};
    if (two_sides)
      place.other = {0.0, 4.0};
    else
      place.covariance(1, 1) = 4.0;
    const DepthJudgement judgement = judge_depth(reading, expecting(20.0));
    EXPECT_EQ(judgement.verdict, DepthVerdict::Unsure) << judgement.reason;
    EXPECT_NE(judgement.reason.find("beside"), std::string::npos) << judgement.reason;
    place.value.x() = 7.0;  // in the slice it certainly misses, whatever the depth
    const DepthJudgement missed = judge_depth(reading, expecting(20.0));
    EXPECT_EQ(missed.verdict, DepthVerdict::Reject) << missed.reason;
    EXPECT_NE(missed.reason.find("7.0 mm"), std::string::npos) << missed.reason;
    EXPECT_NE(missed.reason.find("certainly more than"), std::string::npos) << missed.reason;
  }
}

TEST(JudgeDepth, CountsTheCalibrationsErrorAsItsOwn) {
  DepthReading reading = good_reading();
  spread_depth(reading.tip, 24.2, 0.15);
  DepthCheckSettings settings = expecting(20.0);
  settings.tip_offset = TipOffset{"n", "s", Millimetres(4.2), Millimetres(0.2)};
  EXPECT_EQ(judge_depth(reading, settings).verdict, DepthVerdict::Accept);
  settings.tip_offset->sigma = Millimetres(1.0);
  EXPECT_EQ(judge_depth(reading, settings).verdict, DepthVerdict::Unsure);
}

}  // namespace
}  // namespace biopsy::imaging
