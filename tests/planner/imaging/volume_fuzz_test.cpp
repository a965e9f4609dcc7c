// Claims about damaged files: whatever the damage, an image is read or refused, never worse. Seeded; run it
// under AddressSanitizer to mean it.
#include <gtest/gtest.h>

#include <random>

#include "planner/imaging/io/read_volume.hpp"
#include "tests/planner/imaging/dicom_fixture.hpp"
#include "tests/planner/imaging/io/jpeg2000_fixture.hpp"
#include "tests/planner/imaging/io/metaimage_fixture.hpp"
#include "tests/planner/imaging/nifti_fixture.hpp"
#include "tests/planner/imaging/refusal.hpp"

namespace biopsy::imaging {
namespace {

// Changes a few bytes, cuts the end off or doubles a piece; half the time only within the first `header`
// bytes.
std::string damaged(std::string content, std::size_t header, std::mt19937& random) {
  const auto below = [&](std::size_t limit) {
    return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random);
  };
  const std::size_t reach = below(2) ? std::min(header, content.size()) : content.size();
  switch (below(4)) {
    case 0:
      content.resize(below(content.size()));
      break;
    case 1:
      content.insert(below(reach), content.substr(below(reach), 1 + below(20)));
      break;
    default:
      for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
        const char values[] = {0, 1, '\xff', '\x7f', '\x80', static_cast<char>(below(256))};
        content[below(reach)] = values[below(6)];
      }
  }
  return content;
}

// Reads `folder` after each of many damages to `file`; returns how many were refused.
int refused_of(const std::filesystem::path& folder, const std::filesystem::path& file, std::size_t header,
               int times) {
  std::mt19937 random(20240229);
  const std::string whole = file_content(file);
  int refused = 0;
  for (int n = 0; n < times; ++n) {
    write_content(file, damaged(whole, header, random));
    try {
      list_series(folder);
      const Volume volume = read_volume(folder);
      EXPECT_EQ(volume.voxels.size(), volume.grid.voxel_count());
      EXPECT_TRUE(volume.grid.X_SI.matrix().allFinite());
      EXPECT_GE(volume.grid.size.minCoeff(), 3);
    } catch (const ConfigError& refusal) {
      EXPECT_FALSE(refusal.what_is_wrong.empty());
      EXPECT_FALSE(refusal.remedy.empty());
      ++refused;
    }
  }
  write_content(file, whole);
  EXPECT_EQ(refusal_of(folder), "accepted");
  return refused;
}

TEST(DamagedFiles, DicomIsReadOrRefused) {
  for (const E_TransferSyntax syntax :
       {EXS_LittleEndianExplicit, EXS_LittleEndianImplicit, EXS_DeflatedLittleEndianExplicit, EXS_RLELossless,
        EXS_JPEGProcess14SV1, EXS_JPEGLSLossless}) {
    ScratchFolder folder;
    SliceRecipe recipe;
    recipe.syntax = syntax;
    write_stack(folder.path(), recipe, 4);
    SCOPED_TRACE(DcmXfer(syntax).getXferName());
    EXPECT_GT(refused_of(folder.path(), folder / "b.dcm", 1200, 150), 30);
  }
}

TEST(DamagedFiles, EnhancedDicomIsReadOrRefused) {
  ScratchFolder folder;
  write_enhanced(folder / "enhanced.dcm", {}, 4);
  EXPECT_GT(refused_of(folder.path(), folder / "enhanced.dcm", 2000, 300), 60);
}

TEST(DamagedFiles, NiftiIsReadOrRefused) {
  ScratchFolder folder;
  write_content(folder / "image.nii", nifti_content(nifti_header()));
  EXPECT_GT(refused_of(folder.path(), folder / "image.nii", 352, 600), 120);
}

TEST(DamagedFiles, PackedNiftiIsReadOrRefused) {
  ScratchFolder folder;
  write_gzip(folder / "image.nii.gz", nifti_content(nifti_header()));
  EXPECT_GT(refused_of(folder.path(), folder / "image.nii.gz", 60, 400), 200);
}

TEST(DamagedFiles, Nifti2IsReadOrRefused) {
  ScratchFolder folder;
  write_content(folder / "image.nii", nifti2_content(false));
  EXPECT_GT(refused_of(folder.path(), folder / "image.nii", 544, 400), 60);
}

TEST(DamagedFiles, MetaImageIsReadOrRefused) {
  for (const bool packed : {false, true}) {
    ScratchFolder folder;
    const std::string header = metaimage_header(packed);
    write_content(folder / "image.mha", header + metaimage_voxels(packed));
    EXPECT_GT(refused_of(folder.path(), folder / "image.mha", header.size(), 400), 80);
  }
}

TEST(DamagedFiles, Jpeg2000IsReadOrRefused) {
  ScratchFolder folder;
  write_jpeg2000_stack(folder.path(), 4);
  EXPECT_GT(refused_of(folder.path(), folder / "b.dcm", 1200, 150), 30);
}

TEST(DamagedFiles, NrrdIsReadOrRefused) {
  ScratchFolder folder;
  const std::string header =
      "NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 4 5 6\n"
      "space directions: (0,1,0) (0,0,-2) (3,0,0)\nkinds: domain domain domain\nendian: little\nencoding: "
      "raw\n"
      "space origin: (10,20,30)\n\n";
  write_content(folder / "image.nrrd", header + std::string(240, '\3'));
  EXPECT_GT(refused_of(folder.path(), folder / "image.nrrd", header.size(), 600), 120);
}

}  // namespace
}  // namespace biopsy::imaging
