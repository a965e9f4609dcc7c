// Claims about reading DICOM series: place, values, encodings.
#include <gtest/gtest.h>

#include <cstring>

#include "planner/imaging/io/read_volume.hpp"
#include "tests/planner/imaging/dicom_fixture.hpp"
#include "tests/planner/imaging/refusal.hpp"
#include "tests/safety/verifies.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::imaging {
namespace {

void expect_at(const Volume& volume, int i, int j, int k, const Point& expected) {
  EXPECT_LT((volume.grid.X_SI * Point(i, j, k) - expected).norm(), 1e-9) << i << ' ' << j << ' ' << k;
}

TEST(DicomReader, PutsAxialCornersWhereTheStandardPutsThem) {
  verifies("R-61");
  ScratchFolder folder;
  SliceRecipe recipe;
  recipe.position = {-10, -20, 30};
  write_stack(folder.path(), recipe, 4);
  const Volume volume = read_volume(folder.path());
  EXPECT_EQ(volume.grid.size, Eigen::Vector3i(8, 6, 4));
  expect_at(volume, 0, 0, 0, {-10, -20, 30});
  expect_at(volume, 7, 0, 0, {-6.5, -20, 30});  // seven columns of 0.5 mm, the second number of PixelSpacing
  expect_at(volume, 0, 5, 0, {-10, -10, 30});   // five rows of 2 mm
  expect_at(volume, 7, 5, 3, {-6.5, -10, 39});
  EXPECT_FLOAT_EQ(volume.at(7, 5, 3), 357.0F);  // 300 + 10 * 5 + 7
}

// Rows towards the back, columns towards the feet: rows x columns points to the right of the patient (-x), so
// the leftmost slice comes first.
TEST(DicomReader, PutsSagittalCornersWhereHandArithmeticPutsThem) {
  ScratchFolder folder;
  SliceRecipe recipe;
  recipe.orientation = "0\\1\\0\\0\\0\\-1";
  const double places[3] = {10, 16, 13};
  for (int n = 0; n < 3; ++n) {
    recipe.position = {places[n], -20, 30};
    recipe.pixel = [n](int i, int j) { return 1000 * n + 10 * j + i; };
    write_slice(folder / ("any" + std::to_string(n)), recipe);  // DICOM is known by content, not by name
  }
  const Volume volume = read_volume(folder.path());
  expect_at(volume, 0, 0, 0, {16, -20, 30});
  expect_at(volume, 7, 5, 0, {16, -16.5, 20});
  expect_at(volume, 0, 0, 2, {10, -20, 30});
  EXPECT_FLOAT_EQ(volume.at(7, 5, 0), 1057.0F);
  EXPECT_FLOAT_EQ(volume.at(1, 2, 1), 2021.0F);
  EXPECT_FLOAT_EQ(volume.at(1, 2, 2), 21.0F);
  EXPECT_NEAR(volume.grid.X_SI.linear().determinant(), 0.5 * 2 * 3, 1e-12);  // right-handed
}

TEST(DicomReader, KeepsWhoseImageItIs) {
  ScratchFolder folder;
  write_stack(folder.path(), {}, 3);
  const SeriesIdentity identity = read_volume(folder.path()).identity;
  EXPECT_EQ(identity.patient_name, "Doe^Jane");
  EXPECT_EQ(identity.patient_id, "phantom");
  EXPECT_EQ(identity.study_uid, "1.2.3");
  EXPECT_EQ(identity.series_uid, "1.2.3.4");
  EXPECT_EQ(identity.frame_of_reference_uid, "1.2.3.5");
  EXPECT_EQ(identity.modality, "MR");
  EXPECT_EQ(identity.description, "T2 test");
  EXPECT_EQ(identity.date, "20240229");
}

TEST(DicomReader, TurnsLatinLettersIntoUtf8) {
  ScratchFolder folder;
  SliceRecipe recipe;
  recipe.change = [](DcmDataset& dataset) {
    dataset.putAndInsertString(DCM_SpecificCharacterSet, "ISO_IR 100");
    dataset.putAndInsertString(DCM_PatientName, "M\xfcller");
  };
  write_stack(folder.path(), recipe, 3);
  EXPECT_EQ(read_volume(folder.path()).identity.patient_name, "M\xc3\xbcller");
}

TEST(DicomReader, ReadsTheSamePixelsFromEveryEncoding) {
  for (const E_TransferSyntax syntax :
       {EXS_LittleEndianImplicit, EXS_LittleEndianExplicit, EXS_BigEndianExplicit,
        EXS_DeflatedLittleEndianExplicit, EXS_RLELossless, EXS_JPEGProcess14, EXS_JPEGProcess14SV1,
        EXS_JPEGLSLossless}) {
    ScratchFolder folder;
    SliceRecipe recipe;
    recipe.syntax = syntax;
    recipe.columns = 33;
    recipe.is_signed = false;
    recipe.pixel = [](int i, int j) { return 7 * i + 501 * j; };
    write_stack(folder.path(), recipe, 3);
    SCOPED_TRACE(DcmXfer(syntax).getXferName());
    const Volume volume = read_volume(folder.path());
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 6; ++j)
        for (int i = 0; i < 33; ++i)
          ASSERT_EQ(volume.at(i, j, k), static_cast<float>(7 * i + 501 * j + 100 * k));
  }
}

TEST(DicomReader, ReadsEveryPixelWidthWithItsSign) {
  for (const E_TransferSyntax syntax : {EXS_LittleEndianExplicit, EXS_BigEndianExplicit})
    for (const int bits : {8, 16, 32})
      for (const bool is_signed : {false, true}) {
        if (bits == 32 && syntax == EXS_BigEndianExplicit) continue;  // refused: see below
        ScratchFolder folder;
        SliceRecipe recipe;
        recipe.syntax = syntax;
        recipe.bits_allocated = recipe.bits_stored = bits;
        recipe.is_signed = is_signed;
        recipe.columns = 7;  // odd: a row does not end on a word
        const int lowest = is_signed ? -(1 << (std::min(bits, 24) - 1)) : 0;
        recipe.pixel = [&](int i, int j) { return i == 0 && j == 0 ? lowest : 6 * j - i + 6; };
        for (int k = 0; k < 3; ++k) {
          recipe.position[2] = k;
          write_slice(folder / std::to_string(k), recipe);
        }
        SCOPED_TRACE(testing::Message() << bits << (is_signed ? " signed" : " unsigned"));
        const Volume volume = read_volume(folder.path());
        for (int j = 0; j < 6; ++j)
          for (int i = 0; i < 7; ++i) ASSERT_EQ(volume.at(i, j, 1), static_cast<float>(recipe.pixel(i, j)));
      }
}

// Older scanners keep overlays in the bits that pixels do not use.
TEST(DicomReader, IgnoresBitsThatAreNotStored) {
  ScratchFolder folder;
  SliceRecipe recipe;
  recipe.bits_stored = 12;
  recipe.pixel = [](int i, int j) { return 0x5000 + (j == 0 ? 0xfff - i : i); };
  write_stack(folder.path(), recipe, 3, 1.5);
  const Volume volume = read_volume(folder.path());
  EXPECT_EQ(volume.at(0, 0, 0), -1.0F);  // 0xfff in 12 bits with a sign
  EXPECT_EQ(volume.at(4, 0, 0), -5.0F);
  EXPECT_EQ(volume.at(4, 1, 0), 4.0F);
}

TEST(DicomReader, AppliesSlopeAndInterceptOfEachSlice) {
  ScratchFolder folder;
  SliceRecipe recipe;
  for (int k = 0; k < 3; ++k) {
    recipe.position[2] = 2.0 * k;
    recipe.change = [k](DcmDataset& dataset) {
      dataset.putAndInsertString(DCM_RescaleSlope, k == 1 ? "0.5" : "2");
      dataset.putAndInsertString(DCM_RescaleIntercept, "-1000");
    };
    write_slice(folder / std::to_string(k), recipe);
  }
  const Volume volume = read_volume(folder.path());
  EXPECT_EQ(volume.at(3, 2, 0), 2 * 23.0F - 1000);
  EXPECT_EQ(volume.at(3, 2, 1), 0.5F * 23.0F - 1000);
}

TEST(DicomReader, TakesEnhancedFramesFromTheirFunctionalGroups) {
  for (const E_TransferSyntax syntax : {EXS_LittleEndianExplicit, EXS_RLELossless, EXS_JPEGLSLossless}) {
    ScratchFolder folder;
    SliceRecipe recipe;
    recipe.syntax = syntax;
    recipe.position = {1, 2, 3};
    write_enhanced(folder / "enhanced.dcm", recipe, 5);
    const Volume volume = read_volume(folder / "enhanced.dcm");
    EXPECT_EQ(volume.grid.size, Eigen::Vector3i(8, 6, 5));
    expect_at(volume, 7, 5, 4, {4.5, 12, 15});
    EXPECT_EQ(volume.at(3, 2, 4), 2.0F * 423 + 4);  // slope 2, intercept of frame 4
    EXPECT_EQ(volume.files.size(), 1U);
  }
}

TEST(DicomReader, ReadsFilesWhosePreambleWasLost) {
  ScratchFolder folder;
  SliceRecipe recipe;
  recipe.syntax = EXS_LittleEndianImplicit;  // what a file without a header is, by the standard
  write_stack(folder.path(), recipe, 3);
  for (const char* name : {"a.dcm", "b.dcm", "c.dcm"}) {
    const std::string content = file_content(folder / name);
    const std::uint32_t meta_length = *reinterpret_cast<const std::uint32_t*>(content.data() + 132 + 8);
    write_content(folder / name, content.substr(132 + 12 + meta_length));
  }
  EXPECT_EQ(read_volume(folder.path()).at(3, 2, 1), 123.0F);
}

TEST(DicomReader, WarnsWhenTheStatedSpacingContradictsThePositions) {
  ScratchFolder folder;
  SliceRecipe recipe;
  recipe.change = [](DcmDataset& dataset) { dataset.putAndInsertString(DCM_SpacingBetweenSlices, "3.3"); };
  write_stack(folder.path(), recipe, 3);
  const Volume volume = read_volume(folder.path());
  EXPECT_DOUBLE_EQ(volume.grid.spacing_mm().z(), 3.0);
  ASSERT_EQ(volume.warnings.size(), 1U);
  EXPECT_NE(volume.warnings[0].find("SpacingBetweenSlices says 3.3 mm"), std::string::npos)
      << volume.warnings[0];
}

}  // namespace
}  // namespace biopsy::imaging
