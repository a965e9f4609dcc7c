// What `check` and `calibrate-tip` say of the images they are given. Inputs: scenes from a formula with a
// needle of known depth, written as NIfTI by the test.
#include <cmath>

#include "robot/console/server/nifti_bytes.hpp"
#include "tests/key_files.hpp"
#include "tests/planner/imaging/analytic_scene.hpp"
#include "tests/robot/cli/command.hpp"

namespace biopsy::cli_tests {
namespace {

namespace scene = imaging::scene;

Volume with_needle(const Grid& grid, double depth_mm) {
  return scene::imaged(grid, [&](const Point& p) {
    return scene::tissue(p) * scene::left_by_needle(p, scene::kEntry, scene::kAxis, depth_mm, 1.8) +
           4.0 * scene::grain(p);
  });
}

struct DepthImages : testing::Test {
  ScratchFolder folder;

  void SetUp() override {
    save("before.nii", scene::imaged(scene::grid(1.0, 2.0), [](const Point& p) { return scene::tissue(p); }));
    save("after.nii", with_needle(scene::grid(1.0, 2.0), 20.0));
    make_key_files(folder / "key.pem", folder / "key.pub.pem");
  }
  void save(const std::string& name, const Volume& volume) const {
    folder.write(name, console::nifti_bytes(volume));
  }
  std::string path(const std::string& name) const { return "'" + (folder / name).string() + "'"; }
  std::string images(const std::string& after) const {
    return " --before " + path("before.nii") + " --after " + path(after) +
           " --entry=18,-3,-4 --axis=-1,-0.25,0.3";  // the scene's, in R, A, S
  }
  Outcome calibrated(const std::string& after) const {
    return biopsy("calibrate-tip" + images(after) + " --depth 18 --needle n --sequence s --key " +
                  path("key.pem") + " --out " + path("tip"));
  }
  void expect_no_calibration(const std::string& after, const std::string& reason) const {
    const Outcome outcome = calibrated(after);
    EXPECT_EQ(outcome.code, 2) << outcome.text;
    EXPECT_NE(outcome.text.find(reason), std::string::npos) << outcome.text;
    EXPECT_FALSE(std::filesystem::exists(folder / "tip"));
  }
};

TEST_F(DepthImages, OfADefaultGeometryAreWarnedOf) {
  Volume lost = with_needle(scene::grid(1.0, 2.0), 20.0);
  lost.grid.X_SI = AffineTransform::Identity();
  save("lost.nii", lost);
  const Outcome outcome = standard_output("check" + images("lost.nii") + " --json");
  ASSERT_EQ(outcome.code, 0) << outcome.text;
  const auto json = nlohmann::json::parse(outcome.text);
  ASSERT_EQ(json["warnings"].size(), 1U) << outcome.text;
  EXPECT_NE(json["warnings"][0].get<std::string>().find("image after: the geometry is a default"),
            std::string::npos);
  EXPECT_NE(biopsy("check" + images("lost.nii")).text.find("\nwarning   image after"), std::string::npos);
}

TEST_F(DepthImages, MayBeASlabOfTwoSlices) {
  Grid slab;
  slab.size = {80, 80, 2};
  const Direction across = scene::kAxis.unitOrthogonal();
  slab.X_SI.linear() << scene::kAxis, across, 3.0 * scene::kAxis.cross(across);
  slab.X_SI.translation() = scene::kEntry + 12.0 * scene::kAxis - slab.X_SI.linear() * Point(39.5, 39.5, 0.5);
  save("slab.nii", with_needle(slab, 20.0));
  const Outcome outcome = standard_output("check" + images("slab.nii") + " --json");
  ASSERT_EQ(outcome.code, 0) << outcome.text;
  const auto json = nlohmann::json::parse(outcome.text);
  ASSERT_TRUE(json["tip_found"].get<bool>()) << outcome.text;
  EXPECT_NEAR(json["image_depth_mm"].get<double>(), 20.0, 0.7);
}

TEST_F(DepthImages, CalibrateATipThatACheckThenUses) {
  const Outcome outcome = calibrated("after.nii");
  ASSERT_EQ(outcome.code, 0) << outcome.text;
  const std::string check =
      "check" + images("after.nii") + " --json --tip-calibration " + path("tip/tip_calibration.toml");
  const Outcome used = standard_output(check + " --public-key " + path("key.pub.pem"));
  ASSERT_EQ(used.code, 0) << used.text;
  EXPECT_NEAR(nlohmann::json::parse(used.text)["image_depth_mm"].get<double>(), 18.0, 0.01);
  make_key_files(folder / "other.pem", folder / "other.pub.pem");
  const Outcome other = biopsy(check + " --public-key " + path("other.pub.pem"));
  EXPECT_EQ(other.code, 2);
  EXPECT_NE(other.text.find("signed with another key"), std::string::npos) << other.text;
}

// A wrong calibration would put every later depth wrong.
TEST_F(DepthImages, ThatShowNoEndOfTheVoidCalibrateNothing) {
  save("through.nii", with_needle(scene::grid(1.0, 2.0), 300.0));
  expect_no_calibration("through.nii", "goes on to the end");
}

TEST_F(DepthImages, OfSomethingElseCalibrateNothing) {
  save("other.nii", scene::imaged(scene::grid(1.0, 2.0), [](const Point& p) {
         return scene::tissue({-p.y(), p.z(), p.x()}) *
                scene::left_by_needle(p, scene::kEntry, scene::kAxis, 20.0, 1.8);
       }));
  expect_no_calibration("other.nii", "match");
}

TEST_F(DepthImages, OfAnInterruptedVoidCalibrateNothing) {
  save("two.nii", scene::imaged(scene::grid(1.0, 2.0), [](const Point& p) {
         const double t = (p - scene::kEntry).dot(scene::kAxis);
         const double missing = 1.0 / (1.0 + std::exp(-3.0 * (4.0 - std::abs(t - 10.0))));
         const double left = scene::left_by_needle(p, scene::kEntry, scene::kAxis, 24.0, 1.8);
         return scene::tissue(p) * (left + missing * (1.0 - left));
       }));
  expect_no_calibration("two.nii", "interrupted");
}

}  // namespace
}  // namespace biopsy::cli_tests
