#include "tests/planner/imaging/dicom_fixture.hpp"

#include <dcmtk/dcmdata/dcrleerg.h>
#include <dcmtk/dcmjpeg/djencode.h>
#include <dcmtk/dcmjpls/djencode.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <vector>

namespace biopsy::imaging {
namespace {

void ready_encoders() {
  static const bool ready = [] {
    DcmRLEEncoderRegistration::registerCodecs();
    DJEncoderRegistration::registerCodecs();
    DJLSEncoderRegistration::registerCodecs();
    return true;
  }();
  ASSERT_TRUE(ready);
}

void put_pixels(DcmDataset& dataset, const SliceRecipe& recipe, int frames) {
  std::vector<Uint8> bytes;
  for (int k = 0; k < frames; ++k)
    for (int j = 0; j < recipe.rows; ++j)
      for (int i = 0; i < recipe.columns; ++i) {
        const auto value = static_cast<Uint32>(recipe.pixel(i, j) + (frames > 1 ? 100 * k : 0));
        for (int byte = 0; byte < recipe.bits_allocated / 8; ++byte)
          bytes.push_back(static_cast<Uint8>(value >> (8 * byte)));
      }
  if (recipe.bits_allocated == 8) {
    ASSERT_TRUE(dataset.putAndInsertUint8Array(DCM_PixelData, bytes.data(), bytes.size()).good());
    return;
  }
  std::vector<Uint16> words(bytes.size() / 2);
  std::memcpy(words.data(), bytes.data(), bytes.size());
  ASSERT_TRUE(dataset.putAndInsertUint16Array(DCM_PixelData, words.data(), words.size()).good());
}

void put_header(DcmDataset& dataset, const SliceRecipe& recipe, const char* sop_class) {
  const auto text = [&](const DcmTagKey& tag, const std::string& value) {
    dataset.putAndInsertString(tag, value.c_str());
  };
  const auto number = [&](const DcmTagKey& tag, int value) {
    dataset.putAndInsertUint16(tag, static_cast<Uint16>(value));
  };
  static int instances = 0;
  text(DCM_SOPClassUID, sop_class);
  text(DCM_SOPInstanceUID, fmt::format("1.2.3.99.{}", ++instances));
  text(DCM_StudyInstanceUID, "1.2.3");
  text(DCM_SeriesInstanceUID, recipe.series_uid);
  text(DCM_FrameOfReferenceUID, "1.2.3.5");
  text(DCM_PatientID, "phantom");
  text(DCM_PatientName, "Doe^Jane");
  text(DCM_Modality, "MR");
  text(DCM_SeriesDescription, "T2 test");
  text(DCM_SeriesDate, "20240229");
  text(DCM_ImageType, "ORIGINAL\\PRIMARY\\M");
  text(DCM_PhotometricInterpretation, "MONOCHROME2");
  number(DCM_SamplesPerPixel, 1);
  number(DCM_Columns, recipe.columns);
  number(DCM_Rows, recipe.rows);
  number(DCM_BitsAllocated, recipe.bits_allocated);
  number(DCM_BitsStored, recipe.bits_stored);
  number(DCM_HighBit, recipe.bits_stored - 1);
  number(DCM_PixelRepresentation, recipe.is_signed ? 1 : 0);
}

std::string position_text(const SliceRecipe& recipe, double further = 0.0) {
  return fmt::format("{}\\{}\\{}", recipe.position[0], recipe.position[1], recipe.position[2] + further);
}

void save(DcmFileFormat& content, const std::filesystem::path& file, E_TransferSyntax syntax) {
  ready_encoders();
  ASSERT_TRUE(content.getDataset()->chooseRepresentation(syntax, nullptr).good());
  ASSERT_TRUE(content.saveFile(file.c_str(), syntax).good());
}

}  // namespace

void write_slice(const std::filesystem::path& file, const SliceRecipe& recipe) {
  DcmFileFormat content;
  DcmDataset& dataset = *content.getDataset();
  put_header(dataset, recipe, UID_MRImageStorage);
  dataset.putAndInsertString(DCM_ImagePositionPatient, position_text(recipe).c_str());
  dataset.putAndInsertString(DCM_ImageOrientationPatient, recipe.orientation.c_str());
  dataset.putAndInsertString(DCM_PixelSpacing, recipe.pixel_spacing.c_str());
  put_pixels(dataset, recipe, 1);
  recipe.change(dataset);
  save(content, file, recipe.syntax);
}

void write_stack(const std::filesystem::path& folder, SliceRecipe recipe, int slices, double step) {
  std::filesystem::create_directories(folder);
  const auto pixel = recipe.pixel;
  const double z = recipe.position[2];
  for (int k = 0; k < slices; ++k) {
    recipe.position[2] = z + step * k;
    recipe.pixel = [pixel, k](int i, int j) { return pixel(i, j) + 100 * k; };
    write_slice(folder / (std::string(1, static_cast<char>('a' + k)) + ".dcm"), recipe);
  }
}

void write_enhanced(const std::filesystem::path& file, SliceRecipe recipe, int frames) {
  DcmFileFormat content;
  DcmDataset& dataset = *content.getDataset();
  put_header(dataset, recipe, UID_EnhancedMRImageStorage);
  dataset.putAndInsertString(DCM_NumberOfFrames, std::to_string(frames).c_str());
  const auto group = [&](const DcmTagKey& groups, long number, const DcmTagKey& sequence) {
    DcmItem *item = nullptr, *first = nullptr;
    dataset.findOrCreateSequenceItem(groups, item, number);
    item->findOrCreateSequenceItem(sequence, first, 0);
    return first;
  };
  group(DCM_SharedFunctionalGroupsSequence, 0, DCM_PlaneOrientationSequence)
      ->putAndInsertString(DCM_ImageOrientationPatient, recipe.orientation.c_str());
  group(DCM_SharedFunctionalGroupsSequence, 0, DCM_PixelMeasuresSequence)
      ->putAndInsertString(DCM_PixelSpacing, recipe.pixel_spacing.c_str());
  for (int k = 0; k < frames; ++k) {
    group(DCM_PerFrameFunctionalGroupsSequence, k, DCM_PlanePositionSequence)
        ->putAndInsertString(DCM_ImagePositionPatient, position_text(recipe, 3.0 * k).c_str());
    DcmItem* scale = group(DCM_PerFrameFunctionalGroupsSequence, k, DCM_PixelValueTransformationSequence);
    scale->putAndInsertString(DCM_RescaleSlope, "2");
    scale->putAndInsertString(DCM_RescaleIntercept, std::to_string(k).c_str());
  }
  put_pixels(dataset, recipe, frames);
  recipe.change(dataset);
  save(content, file, recipe.syntax);
}

}  // namespace biopsy::imaging
