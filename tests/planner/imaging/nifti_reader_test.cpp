// Claims about reading NIfTI-1.
#include "planner/imaging/io/nifti/nifti_reader.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/planner/imaging/nifti_fixture.hpp"
#include "tests/planner/imaging/refusal.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::imaging {
namespace {

struct NiftiReader : testing::Test {
  ScratchFolder folder;
  nifti_1_header header = nifti_header();

  Volume read(const std::string& content) {
    write_content(folder / "image.nii", content);
    return read_volume(folder / "image.nii");
  }
  void expect_refused(const std::string& content, const char* reason) {
    write_content(folder / "image.nii", content);
    EXPECT_REFUSED(folder / "image.nii", "image.nii", reason);
  }
  void expect_refused(const char* reason) { expect_refused(nifti_content(header), reason); }
};

TEST_F(NiftiReader, CarriesRasToLps) {
  verifies("R-61");
  const Volume volume = read(nifti_content(header));
  EXPECT_EQ(volume.grid.size, Eigen::Vector3i(4, 5, 6));
  // Voxel (3, 4, 5): RAS (10 + 3, 20 + 8, 30 + 15), so LPS (-13, -28, 45).
  EXPECT_TRUE((volume.grid.X_SI * Point(3, 4, 5)).isApprox(Point(-13, -28, 45)));
  EXPECT_EQ(volume.at(0, 0, 0), -10.0F);
  EXPECT_EQ(volume.at(3, 4, 5), 109.0F);
  EXPECT_EQ(volume.at(1, 0, 0), -9.0F);  // i fastest
  EXPECT_EQ(volume.format, "NIfTI");
  EXPECT_TRUE(volume.warnings.empty());
}

TEST_F(NiftiReader, ReadsEveryNumberType) {
  const auto expect_same = [&]<class Number>(Number, short datatype) {
    header.datatype = datatype;
    header.bitpix = 8 * sizeof(Number);
    const Volume volume = read(nifti_content<Number>(header));
    for (std::size_t n = 0; n < 120; ++n)
      ASSERT_EQ(volume.voxels[n], static_cast<float>(static_cast<Number>(static_cast<int>(n) - 10)))
          << datatype;
  };
  expect_same(std::int8_t{}, DT_INT8);
  expect_same(std::uint8_t{}, DT_UINT8);
  expect_same(std::int16_t{}, DT_INT16);
  expect_same(std::uint16_t{}, DT_UINT16);
  expect_same(std::int32_t{}, DT_INT32);
  expect_same(std::uint32_t{}, DT_UINT32);
  expect_same(std::int64_t{}, DT_INT64);
  expect_same(std::uint64_t{}, DT_UINT64);
  expect_same(float{}, DT_FLOAT32);
  expect_same(double{}, DT_FLOAT64);
}

TEST_F(NiftiReader, WarnsWhenIntegersAreTooLargeForAFloat) {
  header.datatype = DT_UINT32;
  header.bitpix = 32;
  EXPECT_EQ(read(nifti_content<std::uint32_t>(header)).warnings.size(), 1U);  // -10 is 4294967286 here
}

TEST_F(NiftiReader, ReadsGzip) {
  write_gzip(folder / "image.nii.gz", nifti_content(header));
  EXPECT_EQ(read_volume(folder / "image.nii.gz").at(3, 4, 5), 109.0F);
}

TEST_F(NiftiReader, AppliesSlopeAndInterceptUnlessSlopeIsZero) {
  header.scl_slope = 0.5F;
  header.scl_inter = 100.0F;
  EXPECT_EQ(read(nifti_content(header)).at(3, 4, 5), 0.5F * 109 + 100);
  header.scl_slope = 0.0F;
  EXPECT_EQ(read(nifti_content(header)).at(3, 4, 5), 109.0F);
}

// A quarter turn about z in RAS: quaternion (cos 45, 0, 0, sin 45) carries i to +A and j to -R; qfac -1
// mirrors k.
TEST_F(NiftiReader, UsesTheQformWhereThereIsNoSform) {
  header.sform_code = 0;
  header.qform_code = 1;
  header.quatern_d = std::sqrt(0.5F);
  header.qoffset_x = 10, header.qoffset_y = 20, header.qoffset_z = 30;
  header.pixdim[0] = -1;
  // Voxel (3, 4, 5): RAS (10 - 8, 20 + 3, 30 - 15), so LPS (-2, -23, 15).
  EXPECT_TRUE((read(nifti_content(header)).grid.X_SI * Point(3, 4, 5)).isApprox(Point(-2, -23, 15), 1e-6));
}

TEST_F(NiftiReader, PrefersTheSformAndWarnsWhenTheQformDisagrees) {
  header.qform_code = 1;
  header.qoffset_x = 10, header.qoffset_y = 20, header.qoffset_z = 30;
  EXPECT_TRUE(read(nifti_content(header)).warnings.empty());
  header.qoffset_z = 30.2F;
  const Volume volume = read(nifti_content(header));
  EXPECT_TRUE((volume.grid.X_SI * Point(0, 0, 0)).isApprox(Point(-10, -20, 30)));
  ASSERT_EQ(volume.warnings.size(), 1U);
  EXPECT_NE(volume.warnings[0].find("0.20 mm apart"), std::string::npos) << volume.warnings[0];
}

TEST_F(NiftiReader, RefusesWhatItCannotPlace) {
  header.sform_code = 0;
  expect_refused("neither sform nor qform");
  header = nifti_header();
  header.srow_y[0] = 0.1F;
  expect_refused("sheared");
  header = nifti_header();
  header.srow_x[0] = 0;
  expect_refused("spacing");
  header.srow_x[0] = 101;
  expect_refused("spacing");
  header.srow_x[0] = std::numeric_limits<float>::quiet_NaN();
  expect_refused("not finite");
  header = nifti_header();
  header.srow_x[3] = 1e6F;
  expect_refused("10 m");
  header = nifti_header();
  header.xyzt_units = NIFTI_UNITS_METER;
  expect_refused("metres");
}

TEST_F(NiftiReader, RefusesWhatIsNotOneVolumeOfRealNumbers) {
  header.dim[0] = 4, header.dim[4] = 2;
  expect_refused("4-D");
  header = nifti_header();
  header.dim[3] = 2;
  expect_refused("at least 3");
  header = nifti_header();
  header.dim[0] = 2;
  expect_refused("at least 3");
  header = nifti_header();
  header.dim[1] = -4;
  expect_refused("at least 3");
  header = nifti_header();
  header.datatype = DT_COMPLEX64, header.bitpix = 64;
  expect_refused("complex");
  header.datatype = DT_RGB24, header.bitpix = 24;
  expect_refused("RGB");
  header.datatype = DT_INT16, header.bitpix = 8;
  expect_refused("damaged");
  header = nifti_header();
  header.scl_slope = std::numeric_limits<float>::infinity();
  expect_refused("scl_slope");
}

TEST_F(NiftiReader, RefusesAVoxelThatIsNoNumber) {
  header.datatype = DT_FLOAT32, header.bitpix = 32;
  std::string content = nifti_content<float>(header);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(content.data() + 352 + 4 * 7, &nan, 4);
  expect_refused(content, "voxel number 7 is not a finite number");
  header.datatype = DT_FLOAT64, header.bitpix = 64;
  content = nifti_content<double>(header);
  const double huge = 1e300;
  std::memcpy(content.data() + 352 + 8 * 7, &huge, 8);
  expect_refused(content, "voxel number 7");
}

TEST_F(NiftiReader, RefusesDataThatEndEarly) {
  const std::string whole = nifti_content(header);
  expect_refused(whole.substr(0, whole.size() - 1), "truncated");
  expect_refused(whole.substr(0, 100), "truncated");
  header.dim[1] = header.dim[2] = header.dim[3] =
      1024;  // two gigabytes promised: nothing is allocated for them
  expect_refused("truncated");
  header = nifti_header();
  write_gzip(folder / "image.nii.gz", whole);
  const std::string packed = file_content(folder / "image.nii.gz");
  write_content(folder / "image.nii.gz", packed.substr(0, packed.size() - 20));
  EXPECT_REFUSED(folder / "image.nii.gz", "image.nii.gz", "truncated or damaged");
  std::string wrong_sum = packed;
  wrong_sum[packed.size() - 6] ^= 1;
  write_content(folder / "image.nii.gz", wrong_sum);
  EXPECT_REFUSED(folder / "image.nii.gz", "image.nii.gz", "truncated or damaged");
}

TEST_F(NiftiReader, RefusesOtherKindsByName) {
  std::memcpy(header.magic, "ni1", 4);
  expect_refused("two files");
  std::memcpy(header.magic, "\0\0\0", 4);
  expect_refused("Analyze");
}

// The same grid and voxels under a header of version 2.
TEST_F(NiftiReader, ReadsVersion2AsVersion1) {
  write_content(folder / "one.nii", nifti_content(header));
  const Volume one = read_volume(folder / "one.nii");
  for (const bool swapped : {false, true}) {
    write_content(folder / "two.nii", nifti2_content(swapped));
    const Volume two = read_volume(folder / "two.nii");
    EXPECT_EQ(two.voxels, one.voxels);
    EXPECT_TRUE(two.grid.X_SI.matrix().isApprox(one.grid.X_SI.matrix()));
  }
  write_gzip(folder / "two.nii.gz", nifti2_content(false));
  EXPECT_EQ(read_volume(folder / "two.nii.gz").voxels, one.voxels);
}

TEST_F(NiftiReader, RefusesVersion2ThatATextTransferDamaged) {
  std::string content = nifti2_content(false);
  content[8] = '\n';
  write_content(folder / "two.nii", content);
  EXPECT_REFUSED(folder / "two.nii", "two.nii", "transfer as text");
  content = nifti2_content(false);
  const std::int64_t huge = std::int64_t{1} << 40;
  std::memcpy(content.data() + 16 + 8, &huge, sizeof(huge));  // dim[1]
  write_content(folder / "two.nii", content);
  EXPECT_REFUSED(folder / "two.nii", "two.nii", "more than 4096");
}

TEST_F(NiftiReader, WarnsOfAGeometryThatIsADefault) {
  const auto warns = [&] {
    write_content(folder / "image.nii", nifti_content(header));
    const auto warnings = read_volume(folder / "image.nii").warnings;
    return std::any_of(warnings.begin(), warnings.end(),
                       [](const std::string& text) { return text.find("default") != std::string::npos; });
  };
  EXPECT_FALSE(warns());
  for (int a = 0; a < 3; ++a)
    for (int c = 0; c < 4; ++c)
      (a == 0 ? header.srow_x : a == 1 ? header.srow_y : header.srow_z)[c] = a == c ? 1.0F : 0.0F;
  EXPECT_TRUE(warns());
  header.srow_z[3] = -20.0F;
  EXPECT_FALSE(warns());
}

}  // namespace
}  // namespace biopsy::imaging
