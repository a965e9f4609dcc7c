// Claims about the files of the simulated scanner, read here byte by byte from the standard.
#include "sim/scanner/dicom_series.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <limits>
#include <map>

#include "robot/common/config_error.hpp"

namespace biopsy::sim {
namespace {

namespace fs = std::filesystem;

std::string content_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::uint32_t number_at(const std::string& bytes, std::size_t at, int count) {
  std::uint32_t value = 0;
  for (int n = 0; n < count; ++n)
    value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes.at(at + n))) << (8 * n);
  return value;
}

// Elements by tag, with padding; throws where the structure does not hold.
std::map<std::uint32_t, std::string> elements_of(const std::string& bytes) {
  EXPECT_EQ(bytes.substr(128, 4), "DICM");
  std::map<std::uint32_t, std::string> elements;
  for (std::size_t at = 132; at < bytes.size();) {
    const std::uint32_t tag = number_at(bytes, at, 2) << 16 | number_at(bytes, at + 2, 2);
    const bool long_form = bytes.substr(at + 4, 2) == "OB" || bytes.substr(at + 4, 2) == "OW";
    const std::uint32_t length = number_at(bytes, at + (long_form ? 8 : 6), long_form ? 4 : 2);
    at += long_form ? 12 : 8;
    EXPECT_EQ(length % 2, 0U);
    EXPECT_TRUE(elements.emplace(tag, bytes.substr(at, length)).second);
    EXPECT_EQ(elements[tag].size(), length);
    at += length;
  }
  return elements;
}

struct DicomSeriesWriter : testing::Test {
  fs::path folder;

  DicomSeriesWriter() {
    std::string pattern = (fs::temp_directory_path() / "biopsy_writer_XXXXXX").string();
    folder = mkdtemp(pattern.data());
  }
  ~DicomSeriesWriter() override {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }

  static Volume volume() {
    Volume result;
    result.grid.size = {4, 3, 3};
    result.grid.X_SI.linear() = Eigen::Vector3d(0.5, 2.0, 3.0).asDiagonal();
    result.grid.X_SI.translation() = Point(-10, 20.25, 30);
    for (int n = 0; n < 36; ++n) result.voxels.push_back(static_cast<float>(n - 3));
    return result;
  }
};

TEST_F(DicomSeriesWriter, WritesWhatTheStandardAsksOfAnMrSlice) {
  const auto files = write_dicom_series(volume(), folder / "series");
  ASSERT_EQ(files.size(), 3U);
  auto second = elements_of(content_of(files[1]));
  EXPECT_EQ(second[0x00020010], std::string("1.2.840.10008.1.2.1\0", 20));
  EXPECT_EQ(second[0x00080016], std::string("1.2.840.10008.5.1.4.1.1.4\0", 26));
  EXPECT_EQ(second[0x00080018], second[0x00020003]);
  EXPECT_EQ(second[0x00200013], "2 ");
  EXPECT_EQ(second[0x00200032], "-10\\20.25\\33");
  EXPECT_EQ(second[0x00200037], "1\\0\\0\\0\\1\\0 ");
  EXPECT_EQ(second[0x00280030], "2\\0.5 ");  // between rows, between columns
  EXPECT_EQ(number_at(second[0x00280010], 0, 2), 3U);
  EXPECT_EQ(number_at(second[0x00280011], 0, 2), 4U);
  EXPECT_EQ(second[0x7fe00010].size(), 24U);
  EXPECT_EQ(number_at(second[0x7fe00010], 0, 2), 9U);  // voxel 12 of the volume
  EXPECT_EQ(number_at(elements_of(content_of(files[0]))[0x7fe00010], 0, 2),
            0xfffdU);  // -3 in two's complement
}

TEST_F(DicomSeriesWriter, GivesOneSeriesManyInstances) {
  const auto files = write_dicom_series(volume(), folder / "series");
  auto first = elements_of(content_of(files[0])), second = elements_of(content_of(files[1]));
  for (const std::uint32_t same : {0x0020000dU, 0x0020000eU, 0x00200052U})
    EXPECT_EQ(first[same], second[same]);
  EXPECT_NE(first[0x00080018], second[0x00080018]);
  EXPECT_NE(first[0x0020000d], first[0x0020000e]);
  EXPECT_EQ(first[0x0020000e].substr(0, 5), "2.25.");
}

TEST_F(DicomSeriesWriter, WritesTheSameBytesForTheSameVolumeAndOtherUidsForAnother) {
  const auto once = write_dicom_series(volume(), folder / "once"),
             twice = write_dicom_series(volume(), folder / "twice");
  for (std::size_t n = 0; n < once.size(); ++n) EXPECT_EQ(content_of(once[n]), content_of(twice[n]));
  Volume other = volume();
  other.voxels[17] += 1.0F;
  const auto third = write_dicom_series(other, folder / "other");
  EXPECT_NE(elements_of(content_of(once[0]))[0x0020000e], elements_of(content_of(third[0]))[0x0020000e]);
}

TEST_F(DicomSeriesWriter, WritesALeftHandedGridBackToFront) {
  Volume mirrored = volume();
  mirrored.grid.X_SI.linear().col(2) *= -1;
  const auto files = write_dicom_series(mirrored, folder / "series");
  EXPECT_EQ(elements_of(content_of(files[0]))[0x00200032], "-10\\20.25\\24");
  EXPECT_EQ(number_at(elements_of(content_of(files[0]))[0x7fe00010], 0, 2), 21U);  // voxel 24: slice k = 2
}

TEST_F(DicomSeriesWriter, RefusesWhatWouldNotBeASeries) {
  Volume bad = volume();
  bad.voxels.pop_back();
  EXPECT_THROW(write_dicom_series(bad, folder / "a"), ConfigError);
  bad = volume();
  bad.voxels[3] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(write_dicom_series(bad, folder / "a"), ConfigError);
  bad = volume();
  bad.grid.X_SI.linear()(0, 2) = 0.1;
  EXPECT_THROW(write_dicom_series(bad, folder / "a"), ConfigError);
  write_dicom_series(volume(), folder / "b");
  EXPECT_THROW(write_dicom_series(volume(), folder / "b"), ConfigError);  // two series must not mix
}

}  // namespace
}  // namespace biopsy::sim
