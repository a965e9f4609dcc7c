// Claims about DICOM that is not read: each refusal names the file and the reason.
#include <gtest/gtest.h>

#include "planner/imaging/io/read_volume.hpp"
#include "tests/planner/imaging/dicom_fixture.hpp"
#include "tests/planner/imaging/refusal.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::imaging {
namespace {

void set(DcmDataset& dataset, const DcmTagKey& tag, const char* value) {
  dataset.putAndInsertString(tag, value);
}

// A stack of four slices, b.dcm of which is changed.
struct DicomRefusals : testing::Test {
  ScratchFolder folder;

  void change_slice_b(const std::function<void(DcmDataset&)>& change, SliceRecipe recipe = {}) {
    write_stack(folder.path(), recipe, 4);
    recipe.position[2] += 3.0;
    recipe.change = change;
    write_slice(folder / "b.dcm", recipe);
  }
};

TEST_F(DicomRefusals, TwoOrientationsNamingBothFiles) {
  change_slice_b([](DcmDataset& d) { set(d, DCM_ImageOrientationPatient, "0\\1\\0\\0\\0\\-1"); });
  EXPECT_REFUSED(folder.path(), "a.dcm and ", "two orientations");
  EXPECT_REFUSED(folder.path(), "b.dcm", "localiser");
}

TEST_F(DicomRefusals, AScoutAmongTheSlices) {
  change_slice_b([](DcmDataset& d) { set(d, DCM_ImageType, "ORIGINAL\\PRIMARY\\LOCALIZER"); });
  EXPECT_REFUSED(folder.path(), "b.dcm", "localiser (scout)");
}

TEST_F(DicomRefusals, AMissingSliceSayingBetweenWhichFiles) {
  write_stack(folder.path(), {}, 5);
  std::filesystem::remove(folder / "c.dcm");
  EXPECT_REFUSED(folder.path(), "b.dcm and ", "gap of 6.000 mm where the others are 3.000 mm");
  EXPECT_REFUSED(folder.path(), "d.dcm", "a slice is missing");
}

TEST_F(DicomRefusals, TwoSlicesAtOnePlace) {
  change_slice_b([](DcmDataset& d) { set(d, DCM_ImagePositionPatient, "0\\0\\0"); });
  EXPECT_REFUSED(folder.path(), "a.dcm and ", "same place");
}

TEST_F(DicomRefusals, ATiltedStack) {
  for (int k = 0; k < 4; ++k) {
    SliceRecipe recipe;
    recipe.position = {0, 0.2 * k, 3.0 * k};
    write_slice(folder / std::to_string(k), recipe);
  }
  EXPECT_REFUSED(folder.path(), "/0 and ", "tilted stack");
}

TEST_F(DicomRefusals, OneOrTwoSlices) {
  write_stack(folder.path(), {}, 2);
  EXPECT_REFUSED(folder.path(), "a.dcm", "only 2 slices");
  EXPECT_REFUSED(folder / "a.dcm", "a.dcm", "only 1 slice");
}

TEST_F(DicomRefusals, TwoSizesTwoSpacingsTwoPatientsTwoFrames) {
  SliceRecipe wide;
  wide.columns = 10;
  wide.position[2] = 3.0;
  write_stack(folder.path(), {}, 4);
  write_slice(folder / "b.dcm", wide);
  EXPECT_REFUSED(folder.path(), "b.dcm", "two sizes");
  change_slice_b([](DcmDataset& d) { set(d, DCM_PixelSpacing, "2\\0.51"); });
  EXPECT_REFUSED(folder.path(), "b.dcm", "two pixel spacings");
  change_slice_b([](DcmDataset& d) { set(d, DCM_PatientID, "somebody else"); });
  EXPECT_REFUSED(folder.path(), "b.dcm", "two patients");
  change_slice_b([](DcmDataset& d) { set(d, DCM_FrameOfReferenceUID, "1.2.3.6"); });
  EXPECT_REFUSED(folder.path(), "b.dcm", "two frames of reference");
}

TEST_F(DicomRefusals, GeometryThatIsMissingOrAbsurd) {
  const std::vector<std::pair<DcmTagKey, const char*>> missing = {
      {DCM_PixelSpacing, "PixelSpacing is missing"},
      {DCM_ImagePositionPatient, "ImagePositionPatient is missing"},
      {DCM_ImageOrientationPatient, "ImageOrientationPatient is"}};
  for (const auto& [tag, reason] : missing) {
    change_slice_b([tag = tag](DcmDataset& d) { d.findAndDeleteElement(tag); });
    EXPECT_REFUSED(folder.path(), "b.dcm", reason);
  }
  for (const char* spacing :
       {"0\\0.5", "2\\-0.5", "101\\0.5", "nan\\0.5", "2", "2\\0,5", "2\\0.5\\1", "2\\0.5mm"}) {
    change_slice_b([&](DcmDataset& d) { set(d, DCM_PixelSpacing, spacing); });
    EXPECT_REFUSED(folder.path(), "b.dcm", "PixelSpacing");
  }
  change_slice_b([](DcmDataset& d) { set(d, DCM_ImageOrientationPatient, "1\\0\\0\\0.1\\1\\0"); });
  EXPECT_REFUSED(folder.path(), "b.dcm", "length 1");
  change_slice_b([](DcmDataset& d) { set(d, DCM_ImageOrientationPatient, "1\\0\\0\\0.6\\0.8\\0"); });
  EXPECT_REFUSED(folder.path(), "b.dcm", "not perpendicular");
}

TEST_F(DicomRefusals, PixelsThatAreNotOneGreyValue) {
  change_slice_b([](DcmDataset& d) { set(d, DCM_PhotometricInterpretation, "MONOCHROME1"); });
  EXPECT_REFUSED(folder.path(), "b.dcm", "MONOCHROME1");
  change_slice_b([](DcmDataset& d) { d.putAndInsertUint16(DCM_SamplesPerPixel, 3); });
  EXPECT_REFUSED(folder.path(), "b.dcm", "colour");
  change_slice_b([](DcmDataset& d) { d.putAndInsertUint16(DCM_BitsAllocated, 64); });
  EXPECT_REFUSED(folder.path(), "b.dcm", "64 bits");
  change_slice_b([](DcmDataset& d) { d.putAndInsertUint16(DCM_HighBit, 31); });
  EXPECT_REFUSED(folder.path(), "b.dcm", "contradict");
  change_slice_b([](DcmDataset& d) { set(d, DCM_RescaleSlope, "0"); });
  EXPECT_REFUSED(folder.path(), "b.dcm", "rescale slope");
  change_slice_b([](DcmDataset& d) { set(d, DCM_ImageType, "ORIGINAL\\PRIMARY\\M\\MOSAIC"); });
  EXPECT_REFUSED(folder.path(), "b.dcm", "mosaic");
  change_slice_b([](DcmDataset& d) { set(d, DCM_NumberOfFrames, "4"); });
  EXPECT_REFUSED(folder.path(), "b.dcm", "4 frames without functional groups");
}

TEST_F(DicomRefusals, ThirtyTwoBitsInBigEndian) {
  SliceRecipe recipe;
  recipe.bits_allocated = recipe.bits_stored = 32;
  recipe.syntax = EXS_BigEndianExplicit;
  write_stack(folder.path(), recipe, 3);
  EXPECT_REFUSED(folder.path(), "a.dcm", "big endian");
}

TEST_F(DicomRefusals, PixelsThatEndEarly) {
  change_slice_b([](DcmDataset& d) { d.putAndInsertUint16(DCM_Rows, 6); });
  const std::string whole = file_content(folder / "b.dcm");
  write_content(folder / "b.dcm", whole.substr(0, whole.size() - 10));
  EXPECT_REFUSED(folder.path(), "b.dcm", "truncated");
}

TEST_F(DicomRefusals, AHeaderThatPromisesMorePixelsThanTheFileHas) {
  for (const int rows : {7, 4096, 65535}) {
    ScratchFolder own;
    SliceRecipe recipe;
    recipe.change = [&](DcmDataset& d) { d.putAndInsertUint16(DCM_Rows, static_cast<Uint16>(rows)); };
    write_stack(own.path(), recipe, 3);
    EXPECT_REFUSED(own.path(), "a.dcm", rows == 65535 ? "outside 1 to 4096" : "truncated");
  }
}

// Wherever the last file is cut, the stack must not become one slice shorter in silence.
TEST_F(DicomRefusals, AFileCutAnywhere) {
  write_stack(folder.path(), {}, 4);
  const std::string whole = file_content(folder / "d.dcm");
  for (std::size_t length = 0; length < whole.size(); length += 7) {
    write_content(folder / "d.dcm", whole.substr(0, length));
    EXPECT_REFUSED(folder.path(), "d.dcm", "");
  }
}

TEST_F(DicomRefusals, EnhancedFramesWithoutTheirPlaces) {
  SliceRecipe recipe;
  recipe.change = [](DcmDataset& d) {
    DcmItem* third = nullptr;
    d.findAndGetSequenceItem(DCM_PerFrameFunctionalGroupsSequence, third, 2);
    third->findAndDeleteElement(DCM_PlanePositionSequence);
  };
  write_enhanced(folder / "enhanced.dcm", recipe, 5);
  EXPECT_REFUSED(folder.path(), "enhanced.dcm (frame 3)", "plane position");
  recipe.change = [](DcmDataset& d) { set(d, DCM_NumberOfFrames, "6"); };
  write_enhanced(folder / "enhanced.dcm", recipe, 5);
  EXPECT_REFUSED(folder.path(), "enhanced.dcm (frame 6)", "functional groups of this frame are missing");
}

}  // namespace
}  // namespace biopsy::imaging
