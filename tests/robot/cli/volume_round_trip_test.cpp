// The simulated scanner writes, the planner reads: two implementations of DICOM that share no code must agree
// on every voxel and on its place.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <random>

#include "planner/imaging/io/read_volume.hpp"
#include "sim/scanner/dicom_series.hpp"

namespace biopsy {
namespace {

namespace fs = std::filesystem;

struct VolumeRoundTrip : testing::Test {
  fs::path folder;
  std::mt19937 random{7};

  VolumeRoundTrip() {
    std::string pattern = (fs::temp_directory_path() / "biopsy_round_trip_XXXXXX").string();
    folder = mkdtemp(pattern.data());
  }
  ~VolumeRoundTrip() override {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }

  // Whole numbers from -2000 to 2000 on an oblique grid; `mirror` makes it left-handed.
  Volume oblique(bool mirror) {
    Volume volume;
    volume.grid.size = {13, 9, 7};
    const Eigen::Matrix3d turn = (Eigen::AngleAxisd(0.61, Eigen::Vector3d(1, 2, 3).normalized()) *
                                  Eigen::AngleAxisd(-1.3, Eigen::Vector3d::UnitY()))
                                     .toRotationMatrix();
    volume.grid.X_SI.linear() = turn * Eigen::Vector3d(0.7, 1.0 / 3.0, mirror ? -2.9 : 2.9).asDiagonal();
    volume.grid.X_SI.translation() = Point(-113.789356708527, 61.123456789012, -8.1296310424805);
    std::uniform_int_distribution<int> number(-2000, 2000);
    for (std::size_t n = 0; n < volume.grid.voxel_count(); ++n)
      volume.voxels.push_back(static_cast<float>(number(random)));
    return volume;
  }

  // Every voxel of `written` is found within 1e-6 mm in `read`, with its value within `tolerance`.
  static void expect_same(const Volume& written, const Volume& read, double tolerance) {
    ASSERT_EQ(written.grid.voxel_count(), read.grid.voxel_count());
    for (int k = 0; k < written.grid.size.z(); ++k)
      for (int j = 0; j < written.grid.size.y(); ++j)
        for (int i = 0; i < written.grid.size.x(); ++i) {
          const Point p_SV = written.grid.X_SI * Point(i, j, k);
          const Eigen::Vector3i at = (read.grid.X_SI.inverse() * p_SV).array().round().cast<int>();
          ASSERT_TRUE(read.grid.contains(at.x(), at.y(), at.z()));
          ASSERT_LT((read.grid.X_SI * at.cast<double>() - p_SV).norm(), 1e-6);
          ASSERT_NEAR(read.at(at.x(), at.y(), at.z()), written.at(i, j, k), tolerance);
        }
  }
};

TEST_F(VolumeRoundTrip, KeepsWholeNumbersAndPlacesOfAnObliqueVolume) {
  for (const bool mirror : {false, true}) {
    const Volume written = oblique(mirror);
    const fs::path where = folder / (mirror ? "left" : "right");
    const auto files = sim::write_dicom_series(written, where);
    const Volume read = imaging::read_volume(where);
    expect_same(written, read, 0.0);
    EXPECT_GT(read.grid.X_SI.linear().determinant(), 0.0);
    ASSERT_EQ(read.files.size(), files.size());
    for (std::size_t n = 0; n < files.size(); ++n)
      EXPECT_EQ(read.files[n], files[n].string());  // rising on the normal
    EXPECT_TRUE(read.warnings.empty());
  }
}

TEST_F(VolumeRoundTrip, KeepsLargeUnsignedNumbers) {
  Volume written = oblique(false);
  for (float& voxel : written.voxels) voxel = std::abs(voxel) * 30.0F;
  sim::write_dicom_series(written, folder / "unsigned");
  expect_same(written, imaging::read_volume(folder / "unsigned"), 0.0);
}

TEST_F(VolumeRoundTrip, KeepsFractionsToHalfAStepOfSixteenBits) {
  Volume written = oblique(false);
  for (float& voxel : written.voxels) voxel = std::sin(voxel) * 1234.5F;
  sim::write_dicom_series(written, folder / "fractions");
  const double range = 2 * 1234.5;
  expect_same(written, imaging::read_volume(folder / "fractions"), 0.51 * range / 65535.0);
  for (float& voxel : written.voxels) voxel = 0.125F;
  sim::write_dicom_series(written, folder / "constant");
  expect_same(written, imaging::read_volume(folder / "constant"), 0.0);
}

TEST_F(VolumeRoundTrip, KeepsWhoseImageItIs) {
  Volume written = oblique(false);
  written.identity = {"M\xc3\xbcller^Jane", "P-17", "1.2.840.1",   "1.2.840.2",
                      "1.2.840.3",          "MR",   "T2 \xc2\xb5", "20240229"};
  sim::write_dicom_series(written, folder / "identity");
  const SeriesIdentity read = imaging::read_volume(folder / "identity").identity;
  EXPECT_EQ(read.patient_name, written.identity.patient_name);
  EXPECT_EQ(read.patient_id, "P-17");
  EXPECT_EQ(read.study_uid, "1.2.840.1");
  EXPECT_EQ(read.series_uid, "1.2.840.2");
  EXPECT_EQ(read.frame_of_reference_uid, "1.2.840.3");
  EXPECT_EQ(read.modality, "MR");
  EXPECT_EQ(read.description, written.identity.description);
  EXPECT_EQ(read.date, "20240229");
}

TEST_F(VolumeRoundTrip, LoadsALargeSeriesFastEnoughToWaitFor) {
  Volume written;
  written.grid.size = {512, 512, 200};
  written.grid.X_SI.linear() = Eigen::Vector3d(0.5, 0.5, 1.0).asDiagonal();
  written.voxels.resize(written.grid.voxel_count());
  for (std::size_t n = 0; n < written.voxels.size(); ++n)
    written.voxels[n] = static_cast<float>((n * 2654435761U) % 65536);
  sim::write_dicom_series(written, folder / "large");
  const auto start = std::chrono::steady_clock::now();
  const Volume read = imaging::read_volume(folder / "large");
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_TRUE(read.voxels == written.voxels);
  std::cout << "512 x 512 x 200, 16 bits: read in " << seconds << " s\n";
  RecordProperty("read_seconds", std::to_string(seconds));
  EXPECT_LT(seconds,
            20.0);  // 2 s is the aim on an idle machine; a busy or sanitized one must not fail for it
}

}  // namespace
}  // namespace biopsy
