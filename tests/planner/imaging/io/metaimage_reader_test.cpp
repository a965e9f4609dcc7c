// Claims about reading MetaImage. Inputs: files written here from the description of the format.
#include "planner/imaging/io/metaimage/metaimage_reader.hpp"

#include <gtest/gtest.h>

#include "tests/planner/imaging/io/metaimage_fixture.hpp"
#include "tests/planner/imaging/refusal.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::imaging {
namespace {

struct MetaImageReader : testing::Test {
  ScratchFolder folder;

  void expect_refused(const std::string& from, const std::string& to, const char* reason) {
    std::string content = metaimage_header(false);
    content.replace(content.find(from), from.size(), to);
    write_content(folder / "image.mha", content + metaimage_voxels(false));
    EXPECT_REFUSED(folder / "image.mha", "image.mha", reason);
  }
};

void expect_the_image(const Volume& volume) {
  EXPECT_EQ(volume.format, "MetaImage");
  ASSERT_EQ(volume.grid.size, Eigen::Vector3i(4, 5, 6));
  EXPECT_EQ(volume.at(0, 0, 0), -10.0F);
  EXPECT_EQ(volume.at(3, 4, 5), 109.0F);
  // i along P, j along I, k along L.
  EXPECT_TRUE((volume.grid.X_SI * Point(3, 4, 5)).isApprox(Point(10 + 5 * 3, 20 + 3, 30 - 4 * 2)));
}

TEST_F(MetaImageReader, ReadsRawAndPackedInOneFileOrTwo) {
  for (const bool packed : {false, true}) {
    write_content(folder / "image.mha", metaimage_header(packed) + metaimage_voxels(packed));
    expect_the_image(read_volume(folder / "image.mha"));
    write_content(folder / "image.mhd", metaimage_header(packed, "image.raw"));
    write_content(folder / "image.raw", metaimage_voxels(packed));
    expect_the_image(read_volume(folder / "image.mhd"));
  }
}

TEST_F(MetaImageReader, ReadsBigEndian) {
  std::string content = metaimage_header(false), voxels = metaimage_voxels(false);
  content.replace(content.find("MSB = False"), 11, "MSB = True ");
  for (std::size_t n = 0; n < voxels.size(); n += 2) std::swap(voxels[n], voxels[n + 1]);
  write_content(folder / "image.mha", content + voxels);
  expect_the_image(read_volume(folder / "image.mha"));
}

TEST_F(MetaImageReader, IsListedBesideOthers) {
  write_content(folder / "image.mha", metaimage_header(false) + metaimage_voxels(false));
  const auto series = list_series(folder.path());
  ASSERT_EQ(series.size(), 1U);
  EXPECT_EQ(series.front().format, "MetaImage");
  EXPECT_TRUE(series.front().problem.empty());
}

TEST_F(MetaImageReader, RefusesWhatIsNoPlainVolume) {
  expect_refused("NDims = 3", "NDims = 4", "4-D");
  expect_refused("MET_SHORT", "MET_OTHER", "MET_OTHER");
  expect_refused("BinaryData = True", "BinaryData = False", "as text");
  expect_refused("0 0 0 -1", "0 0 0 -2", "unit length");
  expect_refused("0 1 0 0 0 -1", "0 1 0 0 1 0", "sheared");
  expect_refused("Offset = 10 20 30\n", "", "Offset is missing");
  expect_refused("TransformMatrix = 0 1 0 0 0 -1 1 0 0\n", "", "TransformMatrix is missing");
  expect_refused("DimSize = 4 5 6", "DimSize = 4 5 600", "truncated");
  expect_refused("ElementSpacing = 1 2 3", "ElementSpacing = 1 2", "3 numbers");
  expect_refused("CompressedData = False", "CompressedData = True", "damaged");
  expect_refused("NDims = 3", "NDims = 3\nElementNumberOfChannels = 3", "channels");
  expect_refused("ElementDataFile = LOCAL", "ElementDataFile = ../secret.raw", "beside the header");
  expect_refused("Offset = 10", "Offset = 1\nOffset = 10", "given twice");
}

}  // namespace
}  // namespace biopsy::imaging
