#include "planner/imaging/depth_check/depth_check.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "robot/common/config_error.hpp"
#include "tests/planner/imaging/analytic_scene.hpp"

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

DepthCheckSettings expecting(double depth) {
  DepthCheckSettings settings;
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
  const DepthCheck free = check_depth(first, second, scene::kEntry, scene::kAxis);
  for (double planned : {5.0, 19.5, 40.0}) {
    const DepthCheck check = check_depth(first, second, scene::kEntry, scene::kAxis, expecting(planned));
    EXPECT_EQ(check.depth.value, free.depth.value);
    EXPECT_EQ(check.sigma.value, free.sigma.value);
  }
}

TEST(DepthCheck, RejectsWhenNoNeedleIsThereAndIsUnsureWhenNoiseHidesEverything) {
  EXPECT_EQ(check_depth(before(), after(20.0, 0.0), scene::kEntry, scene::kAxis).verdict,
            DepthVerdict::Reject);
  const DepthCheck noisy = check_depth(before(), after(20.0, 0.0, 250.0), scene::kEntry, scene::kAxis);
  EXPECT_EQ(noisy.verdict, DepthVerdict::Unsure) << noisy.reason;
}

TEST(DepthCheck, NeverAcceptsImagesOfDifferentTissue) {
  const Volume other = scene::imaged(scene::grid(0.8, 2.4), [](const Point& p) {
    return scene::tissue(Point(-p.y() + 9.0, p.z(), p.x())) *
           scene::left_by_needle(p, scene::kEntry, scene::kAxis, 20.0, 2.0);
  });
  const DepthCheck check = check_depth(before(), other, scene::kEntry, scene::kAxis);
  EXPECT_EQ(check.verdict, DepthVerdict::Unsure) << check.reason;
}

TEST(DepthCheck, IsUnsureWhenTheTipLeavesTheImage) {
  const DepthCheck check = check_depth(before(), after(300.0), scene::kEntry, scene::kAxis);
  EXPECT_EQ(check.verdict, DepthVerdict::Unsure) << check.reason;
}

TEST(DepthCheck, TakesOffTheCalibratedTipOffset) {
  DepthCheckSettings settings;
  const Volume first = before(), second = after(20.0);
  const double plain = check_depth(first, second, scene::kEntry, scene::kAxis, settings).depth.value;
  settings.tip_offset = Millimetres(0.7);
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

TEST(JudgeDepth, DoubtsAnInterruptedVoidARivalTipAndACoarseDepth) {
  DepthReading good;
  good.motion.within_limits = true;
  good.motion.score = 0.95;
  good.motion.points = 10000;
  good.tip.evidence = 50.0, good.tip.control_evidence = 5.0, good.tip.visible = 30.0, good.tip.loss = 0.9;
  good.tip.depth_mm = 20.0, good.tip.sigma_mm = 0.1;
  good.tip.low_mm = 19.8, good.tip.high_mm = 20.2;
  ASSERT_EQ(judge_depth(good, {}).verdict, DepthVerdict::Accept);
  const auto verdict_after = [&](const auto& corrupt) {
    DepthReading reading = good;
    corrupt(reading);
    return judge_depth(reading, {}).verdict;
  };
  EXPECT_EQ(verdict_after([](DepthReading& r) { r.tip.gap_mm = 3.0; }), DepthVerdict::Unsure);
  EXPECT_EQ(verdict_after([](DepthReading& r) { r.tip.rival_against = 3.0; }), DepthVerdict::Unsure);
  EXPECT_EQ(verdict_after([](DepthReading& r) { r.tip.sigma_mm = 0.6; }), DepthVerdict::Unsure);
  EXPECT_EQ(verdict_after([](DepthReading& r) { r.tip.low_mm = 18.0; }), DepthVerdict::Unsure);
  EXPECT_EQ(verdict_after([](DepthReading& r) { r.tip.darkest = 0.1; }), DepthVerdict::Unsure);
  EXPECT_EQ(verdict_after([](DepthReading& r) { r.tip.at_end = true; }), DepthVerdict::Unsure);
  EXPECT_EQ(verdict_after([](DepthReading& r) { r.motion.score = 0.3; }), DepthVerdict::Unsure);
  EXPECT_EQ(verdict_after([](DepthReading& r) { r.motion.within_limits = false; }), DepthVerdict::Unsure);
  EXPECT_EQ(verdict_after([](DepthReading& r) { r.tip.control_evidence = 40.0; }), DepthVerdict::Unsure);
  EXPECT_EQ(verdict_after([](DepthReading& r) { r.tip.loss = 0.1; }), DepthVerdict::Reject);
  EXPECT_NE(verdict_after([](DepthReading& r) { r.tip.sigma_mm = NAN; }), DepthVerdict::Accept);
  EXPECT_NE(verdict_after([](DepthReading& r) { r.tip.depth_mm = NAN; }), DepthVerdict::Accept);
  EXPECT_NE(verdict_after([](DepthReading& r) { r.tip.evidence = NAN; }), DepthVerdict::Accept);
  EXPECT_NE(verdict_after([](DepthReading& r) { r.motion.score = NAN; }), DepthVerdict::Accept);
  EXPECT_EQ(judge_depth({}, {}).verdict, DepthVerdict::Unsure);
}

}  // namespace
}  // namespace biopsy::imaging
