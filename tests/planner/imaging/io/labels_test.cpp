// Which volumes count as label maps. Inputs: regions drawn here; the real label map and the real grey image
// of one liver (../shared/data/images/mr/liver).
#include "planner/imaging/io/labels.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace biopsy::imaging
