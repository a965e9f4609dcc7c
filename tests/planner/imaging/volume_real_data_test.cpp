// Claims about images that nobody here made. Skipped, with a word, where they are not installed.
#include <gtest/gtest.h>

#include <filesystem>

#include "planner/imaging/io/dicom/dicom_pixels.hpp"
#include "planner/imaging/io/nifti/nifti_reader.hpp"
#include "planner/imaging/io/read_volume.hpp"
#include "tests/planner/imaging/refusal.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::imaging {
namespace {

namespace fs = std::filesystem;
const fs::path kImages = source_dir() / "../shared/data/images";
const fs::path kPydicom = "/usr/lib/python3/dist-packages/pydicom/data/test_files";
const fs::path kNibabel = "/usr/lib/python3/dist-packages/nibabel/tests/data";
const fs::path kMricron = "/usr/share/mricron/templates";

#define NEEDS(path) \
  if (!fs::exists(path)) GTEST_SKIP() << "not installed: " << path

Point corner(const Volume& volume) {
  return volume.grid.X_SI * (volume.grid.size.cast<double>() - Point::Ones());
}

TEST(RealImages, ProstatePlanningSeries) {
  NEEDS(kImages / "mr/prostate_planning");
  const Volume volume = read_volume(kImages / "mr/prostate_planning");
  EXPECT_EQ(volume.grid.size, Eigen::Vector3i(320, 320, 40));
  EXPECT_LT((volume.grid.spacing_mm() - Eigen::Vector3d(0.5, 0.5, 3.0)).norm(), 1e-4);
  EXPECT_EQ(volume.files.size(), 40U);
  EXPECT_TRUE(volume.warnings.empty());
  // ImagePositionPatient of the first and last slice, and 319 pixels of 0.5 mm.
  EXPECT_LT((volume.grid.X_SI.translation() - Point(-73.789356708527, -97.73828125, -8.1296310424805)).norm(),
            1e-9);
  EXPECT_LT((corner(volume) - Point(85.7106, 61.7617, 108.8704)).norm(), 1e-3);
}

TEST(RealImages, ProstateGuidanceSeriesIsSpacedByPositionNotThickness) {
  NEEDS(kImages / "mr/prostate_guidance");
  const Volume volume = read_volume(kImages / "mr/prostate_guidance");
  EXPECT_EQ(volume.grid.size, Eigen::Vector3i(320, 256, 20));  // 256 rows of 320 columns
  EXPECT_LT((volume.grid.spacing_mm() - Eigen::Vector3d(0.75, 0.75, 3.6)).norm(), 1e-4);
  ASSERT_EQ(volume.warnings.size(), 1U);
  EXPECT_NE(volume.warnings[0].find("SliceThickness says 3 mm"), std::string::npos);
}

TEST(RealImages, LiverAndItsLabelsShareAGrid) {
  NEEDS(kImages / "mr/liver");
  const Volume image = read_volume(kImages / "mr/liver", "example_mr_sm.nii.gz");
  const Volume labels = read_volume(kImages / "mr/liver/example_seg_mr.nii.gz");
  EXPECT_EQ(image.grid.size, Eigen::Vector3i(117, 91, 20));
  EXPECT_LT((image.grid.spacing_mm() - Eigen::Vector3d(3, 3, 3)).norm(), 1e-5);
  EXPECT_TRUE(image.grid.X_SI.isApprox(labels.grid.X_SI));
  // RAS origin (168.5996, 166.3594, 28.9896), axes towards L, P, S.
  EXPECT_LT((image.grid.X_SI.translation() - Point(-168.5996, -166.3594, 28.9896)).norm(), 1e-3);
  EXPECT_LT((corner(image) - Point(-168.5996 + 348, -166.3594 + 270, 28.9896 + 57)).norm(), 1e-3);
  double liver_ml = 0.0;
  for (const float label : labels.voxels) {
    ASSERT_EQ(label, std::round(label));
    if (label == 5.0F) liver_ml += 27e-3;
  }
  EXPECT_GT(liver_ml, 100.0);  // an organ, not a speck
  EXPECT_LT(liver_ml, 3000.0);
}

TEST(RealImages, NastySeriesAreRefusedByName) {
  NEEDS(kImages / "nasty");
  const fs::path nasty = kImages / "nasty";
  EXPECT_REFUSED(nasty / "d2n_gantrytilting", "IM-0001-0001.dcm", "gantry tilt");
  EXPECT_REFUSED(nasty / "d2n_notavolume", "001.dcm and ", "same place");
  EXPECT_REFUSED(nasty / "d2n_slicecount", "IM-0001-0001-0001.dcm", "only 2 slices");
  EXPECT_REFUSED(nasty / "d2n_sliceorientation", "IM-0001-0001-0001 2.dcm and ", "two orientations");
  EXPECT_REFUSED(nasty / "shear.nii.gz", "shear.nii.gz", "sheared");
  EXPECT_REFUSED(nasty / "minimal.nii.gz", "minimal.nii.gz", "no geometry");
}

TEST(RealImages, OneSliceIsTheSameInEveryEncoding) {
  NEEDS(kPydicom / "MR_small.dcm");
  const auto pixels = [](const char* name) {
    std::vector<float> voxels;
    DicomPixels(kPydicom / name).append_frame(0, 1.0, 0.0, voxels);
    return voxels;
  };
  const std::vector<float> plain = pixels("MR_small.dcm");
  ASSERT_EQ(plain.size(), 64U * 64U);
  EXPECT_EQ(plain[0], 905.0F);  // the first words of the file's pixel data
  EXPECT_EQ(plain[1], 1019.0F);
  for (const char* name :
       {"MR_small_RLE.dcm", "MR_small_bigendian.dcm", "MR_small_expb.dcm", "MR_small_implicit.dcm",
        "MR_small_jpeg_ls_lossless.dcm", "MR_small_padded.dcm", "MR_small_jp2klossless.dcm"})
    EXPECT_EQ(pixels(name), plain) << name;
  try {
    pixels("MR_truncated.dcm");
    FAIL() << "truncated pixels were read";
  } catch (const ConfigError& refusal) {
    EXPECT_NE(refusal.what_is_wrong.find("truncated"), std::string::npos) << refusal.what();
  }
}

TEST(RealImages, FilesOfEveryKindAreListedOrRefusedButNeverWorse) {
  NEEDS(kPydicom);
  for (const fs::directory_entry& entry : fs::directory_iterator(kPydicom)) {
    if (!entry.is_regular_file()) continue;
    EXPECT_NE(refusal_of(entry.path()), "accepted") << entry;  // none is a volume
  }
}

TEST(RealImages, BigEndianNiftiWithAxesToTheLeft) {
  NEEDS(kNibabel / "anatomical.nii");
  const Volume volume = read_volume(kNibabel / "anatomical.nii");
  EXPECT_EQ(volume.grid.size, Eigen::Vector3i(33, 41, 25));
  // RAS affine diag(-2, 2, 2) with origin (32, -40, -16): LPS origin (-32, 40, -16), i to the left, j to the
  // front.
  EXPECT_TRUE(volume.grid.X_SI.translation().isApprox(Point(-32, 40, -16)));
  EXPECT_TRUE(corner(volume).isApprox(Point(-32 + 64, 40 - 80, -16 + 48)));
  EXPECT_REFUSED(kNibabel / "functional.nii", "functional.nii", "4-D");
  EXPECT_REFUSED(kNibabel / "example_nifti2.nii.gz", "example_nifti2.nii.gz", "4-D");
}

TEST(RealImages, TemplatesOfTheBrainPlaceTheMidlineAtZero) {
  NEEDS(kMricron / "ch2.nii.gz");
  const Volume volume = read_volume(kMricron / "ch2.nii.gz");
  EXPECT_EQ(volume.grid.size, Eigen::Vector3i(181, 217, 181));
  EXPECT_TRUE((volume.grid.X_SI * Point(90, 125, 71)).isZero(1e-6));  // the anterior commissure of MNI space
}

}  // namespace
}  // namespace biopsy::imaging
