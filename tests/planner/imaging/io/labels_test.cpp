// Which volumes count as label maps. Inputs: regions drawn here; the real label map and the real grey image
// of one liver (../shared/data/images/mr/liver); atlases and heads of Debian's mricron-data.
#include "planner/imaging/io/labels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "planner/imaging/io/read_volume.hpp"
#include "robot/common/config_error.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::imaging {
namespace {

Volume drawn(float (*value)(int i, int j, int k)) {
  Volume volume;
  volume.grid.size = Eigen::Vector3i(24, 20, 6);
  for (int k = 0; k < 6; ++k)
    for (int j = 0; j < 20; ++j)
      for (int i = 0; i < 24; ++i) volume.voxels.push_back(value(i, j, k));
  return volume;
}

TEST(Labels, AreRegionsOfWholeNumbers) {
  EXPECT_NO_THROW(refuse_unlike_labels(drawn([](int, int, int) { return 0.0F; }), "labels"));
  EXPECT_NO_THROW(refuse_unlike_labels(
      drawn([](int i, int j, int) { return i < 12   ? 1.0F
                                           : j < 10 ? 2.0F
                                                    : 5.0F; }), "labels"));
  EXPECT_NO_THROW(refuse_unlike_labels(
      drawn([](int i, int j, int k) { return i > 4 && i < 9 && j > 5 && j < 10 && k == 2 ? 41.0F : 0.0F; }),
      "labels"));
}

TEST(Labels, AreNotFractionsNegativesOrGreyValues) {
  EXPECT_THROW(refuse_unlike_labels(drawn([](int i, int, int) { return i < 5 ? 0.5F : 1.0F; }), "x"),
               ConfigError);
  EXPECT_THROW(refuse_unlike_labels(drawn([](int i, int, int) { return i < 5 ? -1.0F : 1.0F; }), "x"),
               ConfigError);
  // 22 grey levels of a smooth picture with noise.
  EXPECT_THROW(refuse_unlike_labels(drawn([](int i, int j, int k) {
                                      return static_cast<float>(
                                          (i / 3 + j / 3 + (i * 7919 + j * 104729 + k * 31) % 8) % 22);
                                    }),
                                    "x"),
               ConfigError);
}

TEST(Labels, OfARealLiverAreTakenAndItsGreyImageIsNot) {
  const auto folder = source_dir() / "../shared/data/images/mr/liver";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "not installed: " << folder;
  EXPECT_NO_THROW(refuse_unlike_labels(read_volume(folder / "example_seg_mr.nii.gz"), "labels"));
  try {
    refuse_unlike_labels(read_volume(folder / "example_mr_sm.nii.gz"), "example_mr_sm.nii.gz");
    FAIL() << "a grey image was taken for labels";
  } catch (const ConfigError& refusal) {
    EXPECT_NE(refusal.what_is_wrong.find("no label map"), std::string::npos);
    EXPECT_EQ(refusal.where, "example_mr_sm.nii.gz");
  }
}

// Of a voxel's thickness, or checkered: unusual, but regions.
TEST(Labels, MayBeThinShellsOrAChequeredPhantom) {
  const std::vector<float (*)(int, int, int)> maps{
      [](int i, int j, int) { return static_cast<float>(std::lround(std::hypot(i - 12, j - 10)) == 7); },
      [](int i, int j, int) { return static_cast<float>(std::lround(std::hypot(i - 12, j - 10)) / 2); },
      [](int i, int j, int) { return static_cast<float>((i + j) % 9 == 0); },
      [](int i, int j, int k) { return static_cast<float>(1 + (i / 2 + j / 2 + k / 2) % 3); },
      [](int i, int j, int) { return static_cast<float>(1 + (i / 3 + 2 * (j / 3)) % 7); }};
  for (std::size_t n = 0; n < maps.size(); ++n)
    EXPECT_EQ(refuse_unlike_labels(drawn(maps[n]), "labels"), "") << n;
}

// `levels` values from air to the brightest.
Volume cut(Volume image, int levels) {
  std::vector<float> sorted = image.voxels;
  const auto brightest = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 100 * 99);
  std::nth_element(sorted.begin(), brightest, sorted.end());
  for (float& value : image.voxels)
    value = std::clamp(std::floor(value / *brightest * static_cast<float>(levels)), 0.0F,
                       static_cast<float>(levels - 1));
  return image;
}

void expect_no_labels(const std::filesystem::path& grey, const std::vector<int>& cuts) {
  for (const int levels : cuts) {
    const Volume image = cut(read_volume(grey), levels);
    try {
      refuse_unlike_labels(image, "grey");
      ADD_FAILURE() << grey << " cut to " << levels << " values was taken for labels";
    } catch (const ConfigError& refusal) {
      EXPECT_NE(refusal.remedy.find("--labels-anyway"), std::string::npos);
    }
    EXPECT_NE(refuse_unlike_labels(image, "grey", true), "");
  }
}

TEST(Labels, AreNoGreyImageThatWasCutToAFewValues) {
  const auto folder = source_dir() / "../shared/data/images/mr";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no real images beside the source folder";
  expect_no_labels(folder / "liver/example_mr_sm.nii.gz", {4});
  for (const char* name : {"liver/example_mr_sm.nii.gz", "prostate_guidance", "prostate_planning", "zframe"})
    expect_no_labels(folder / name, {5, 6, 9, 14, 25, 60});
}

const std::filesystem::path kTemplates = "/usr/share/mricron/templates";

TEST(Labels, AreNoGreyHeadThatWasCutToAFewValues) {
  if (!std::filesystem::exists(kTemplates)) GTEST_SKIP() << "not installed: mricron-data";
  for (const char* name : {"ch2.nii.gz", "inia19-t1-brain.nii.gz"})
    expect_no_labels(kTemplates / name, {5, 6, 9, 14, 25, 60});
}

TEST(Labels, OfAtlasesAreTaken) {
  if (!std::filesystem::exists(kTemplates)) GTEST_SKIP() << "not installed: mricron-data";
  for (const char* name : {"aal", "brodmann", "JHU-WhiteMatter-labels-2mm", "natbrainlab", "AICHAmc",
                           "jhu189", "HarvardOxford-cort-maxprob-thr0-1mm", "inia19-NeuroMaps"})
    EXPECT_EQ(refuse_unlike_labels(read_volume(kTemplates / (std::string(name) + ".nii.gz")), name), "");
}

}  // namespace
}  // namespace biopsy::imaging
