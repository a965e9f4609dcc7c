// Claims about reading NRRD.
#include "planner/imaging/io/nrrd/nrrd_reader.hpp"

#include <gtest/gtest.h>

#include "tests/planner/imaging/nifti_fixture.hpp"
#include "tests/planner/imaging/refusal.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::imaging {
namespace {

const std::string kHeader =
    "NRRD0004\n# a comment\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 4 5 6\n"
    "space directions: (0,1,0) (0,0,-2) (3,0,0)\nkinds: domain domain domain\nendian: little\nencoding: raw\n"
    "space origin: (10,20,30)\nSegment0_Name:=liver\n\n";

std::string with(const std::string& from, const std::string& to, std::string header = kHeader) {
  return header.replace(header.find(from), from.size(), to);
}

std::string voxels(bool big = false) {
  std::string bytes;
  for (int n = 0; n < 120; ++n) {
    const int value = n - 10;
    const char low = static_cast<char>(value & 0xff), high = static_cast<char>((value >> 8) & 0xff);
    bytes += big ? std::string{high, low} : std::string{low, high};
  }
  return bytes;
}

struct NrrdReader : testing::Test {
  ScratchFolder folder;

  Volume read(const std::string& content) {
    write_content(folder / "image.nrrd", content);
    return read_volume(folder / "image.nrrd");
  }
  void expect_refused(const std::string& content, const char* reason) {
    write_content(folder / "image.nrrd", content);
    EXPECT_REFUSED(folder / "image.nrrd", "image.nrrd", reason);
  }
};

TEST_F(NrrdReader, PutsCornersWhereHandArithmeticPutsThem) {
  const Volume volume = read(kHeader + voxels());
  EXPECT_EQ(volume.grid.size, Eigen::Vector3i(4, 5, 6));
  EXPECT_TRUE((volume.grid.X_SI * Point(3, 4, 5)).isApprox(Point(25, 23, 22)));  // 10 + 3*5, 20 + 3, 30 - 2*4
  EXPECT_EQ(volume.at(3, 4, 5), 109.0F);
  EXPECT_EQ(volume.at(1, 0, 0), -9.0F);
  EXPECT_EQ(volume.format, "NRRD");
}

TEST_F(NrrdReader, CarriesEveryAnatomicalSpaceToLps) {
  verifies("R-61");
  const auto corner = [&](const char* space) {
    return Point(read(with("left-posterior-superior", space) + voxels()).grid.X_SI * Point(3, 4, 5));
  };
  EXPECT_TRUE(corner("LPS").isApprox(Point(25, 23, 22)));
  EXPECT_TRUE(corner("right-anterior-superior").isApprox(Point(-25, -23, 22)));
  EXPECT_TRUE(corner("RAS").isApprox(Point(-25, -23, 22)));
  EXPECT_TRUE(corner("left-anterior-superior").isApprox(Point(25, -23, 22)));
}

TEST_F(NrrdReader, ReadsBigEndianGzipAndDetachedData) {
  EXPECT_EQ(read(with("little", "big") + voxels(true)).at(3, 4, 5), 109.0F);

  write_gzip(folder / "packed", voxels());
  const std::string packed = file_content(folder / "packed");
  EXPECT_EQ(read(with("raw", "gzip") + packed).at(3, 4, 5), 109.0F);

  write_content(folder / "image.raw", voxels());
  write_content(folder / "image.nhdr", with("endian:", "data file: image.raw\nendian:"));
  const Volume detached = read_volume(folder / "image.nhdr");
  EXPECT_EQ(detached.at(3, 4, 5), 109.0F);
  EXPECT_EQ(detached.files.size(), 2U);
  write_content(folder / "image.raw", voxels().substr(1));
  EXPECT_REFUSED(folder / "image.nhdr", "image.raw", "truncated");
}

TEST_F(NrrdReader, ReadsAFilePackedAsAWhole) {
  write_gzip(folder / "image.nrrd.gz", kHeader + voxels());
  const Volume volume = read_volume(folder / "image.nrrd.gz");
  EXPECT_TRUE((volume.grid.X_SI * Point(3, 4, 5)).isApprox(Point(25, 23, 22)));
  EXPECT_EQ(volume.at(3, 4, 5), 109.0F);
  EXPECT_EQ(volume.at(1, 0, 0), -9.0F);
  EXPECT_TRUE(volume.warnings.empty());

  write_gzip(folder / "image.nrrd.gz", kHeader + voxels() + "more");
  EXPECT_EQ(read_volume(folder / "image.nrrd.gz").warnings.size(), 1U);
  write_gzip(folder / "image.nrrd.gz", (kHeader + voxels()).substr(0, kHeader.size() + 100));
  EXPECT_REFUSED(folder / "image.nrrd.gz", "image.nrrd.gz", "truncated");
  write_gzip(folder / "image.nrrd.gz", with("raw", "gzip") + voxels());
  EXPECT_REFUSED(folder / "image.nrrd.gz", "image.nrrd.gz", "packed twice");
  write_content(folder / "image.nrrd.gz", kHeader + voxels());
  EXPECT_REFUSED(folder / "image.nrrd.gz", "image.nrrd.gz", "not gzip");
  write_gzip(folder / "image.nrrd.gz", kHeader + voxels());
  const std::string whole = file_content(folder / "image.nrrd.gz");
  write_content(folder / "image.nrrd.gz", whole.substr(0, whole.size() - 6));  // within the checksum
  EXPECT_REFUSED(folder / "image.nrrd.gz", "image.nrrd.gz", "truncated");
}

TEST_F(NrrdReader, ReadsHeadersWithWindowsLineEnds) {
  std::string header = kHeader;
  for (std::size_t at = 0; (at = header.find('\n', at)) != std::string::npos; at += 2)
    header.insert(at, "\r");
  EXPECT_EQ(read(header + voxels()).at(3, 4, 5), 109.0F);
}

TEST_F(NrrdReader, RefusesWhatItCannotPlace) {
  expect_refused(with("space: left-posterior-superior\n", "spacings: 1 2 3\n") + voxels(), "no geometry");
  expect_refused(with("left-posterior-superior", "scanner-xyz") + voxels(), "scanner-xyz");
  expect_refused(with("space directions: (0,1,0) (0,0,-2) (3,0,0)\n", "") + voxels(),
                 "\"space directions\" is missing");
  expect_refused(with("space origin: (10,20,30)\n", "") + voxels(), "\"space origin\" is missing");
  for (const char* bad :
       {"(0,1,0) (0,0,-2)", "(0,1,0) (0,0,-2) none", "(0,1,0) (0,0,-2) (3,0)", "(0,1,0) (0,0,-2) (3,0,0",
        "(0,1,0) (0,0,-2) (3,0,x)", "(0,1,0) (0,0,-2) (3,0,nan)", "(0,1,0) (0,0,-2) (3,0,0) (1,0,0)"})
    expect_refused(with("(0,1,0) (0,0,-2) (3,0,0)", bad) + voxels(), "\"space directions\"");
  expect_refused(with("(3,0,0)", "(3,0.1,0)") + voxels(), "sheared");
  expect_refused(with("(3,0,0)", "(0,0,0)") + voxels(), "spacing");
  expect_refused(with("(3,0,0)", "(300,0,0)") + voxels(), "spacing");
  expect_refused(with("kinds:", "space units: \"m\" \"m\" \"m\"\nkinds:") + voxels(), "not mm");
}

TEST_F(NrrdReader, RefusesWhatIsNotOneVolumeOfRealNumbers) {
  expect_refused(with("dimension: 3", "dimension: 4") + voxels(), "4-D");
  expect_refused(with("kinds: domain", "kinds: RGB-color") + voxels(), "rgb-color");
  expect_refused(with("kinds: domain", "kinds: complex") + voxels(), "complex");
  expect_refused(with("sizes: 4 5 6", "sizes: 4 5 2") + voxels(), "at least 3");
  expect_refused(with("sizes: 4 5 6", "sizes: 4 5") + voxels(), "sizes");
  expect_refused(with("sizes: 4 5 6", "sizes: 4 5 -6") + voxels(), "sizes");
  expect_refused(with("sizes: 4 5 6", "sizes: 4 5 99999") + voxels(), "4096");
  expect_refused(with("type: short", "type: block") + voxels(), "block");
}

TEST_F(NrrdReader, RefusesRatherThanGuesses) {
  expect_refused(with("type: short\n", "") + voxels(), "\"type\" is missing");
  expect_refused(with("endian: little\n", "") + voxels(), "\"endian\" is missing");
  expect_refused(with("endian: little", "endian: middle") + voxels(), "middle");
  expect_refused(with("encoding: raw", "encoding: bzip2") + voxels(), "bzip2");
  expect_refused(with("encoding: raw", "encoding: gzip") + voxels(), "not gzip");
  expect_refused(with("endian:", "byte skip: 10\nendian:") + voxels(), "byte skip");
  expect_refused(with("endian:", "sizes: 4 5 6\nendian:") + voxels(), "given twice");
  expect_refused(with("endian:", "rubbish\nendian:") + voxels(), "without a colon");
  expect_refused("NRRD0009" + kHeader.substr(8) + voxels(), "not an NRRD file");
  expect_refused(with("endian:", "data file: ../image.raw\nendian:"), "not one file beside the header");
  expect_refused(with("endian:", "data file: /etc/hostname\nendian:"), "not one file beside the header");
  expect_refused(with("endian:", "data file: LIST\nendian:"), "not one file beside the header");
}

TEST_F(NrrdReader, RefusesDataThatEndEarly) {
  const std::string whole = kHeader + voxels();
  expect_refused(whole.substr(0, whole.size() - 1), "truncated");
  expect_refused(kHeader.substr(0, kHeader.size() - 1), "truncated");
  expect_refused(with("sizes: 4 5 6", "sizes: 1024 1024 1024") + voxels(), "truncated");
}

}  // namespace
}  // namespace biopsy::imaging
