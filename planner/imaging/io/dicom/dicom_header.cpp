#include "planner/imaging/io/dicom/dicom_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "planner/imaging/io/dicom/dicom_fields.hpp"
#include "planner/imaging/io/dicom/dicom_frame.hpp"
#include "planner/imaging/io/dicom/dicom_pixels.hpp"
#include "planner/imaging/io/dicom/dicom_time.hpp"
#include "planner/imaging/io/grid_rules.hpp"
#include "robot/common/text/strict_number.hpp"

namespace biopsy::imaging {
namespace {

void read_scale(DcmItem& item, DicomSlice& slice) {
  const std::string& name = slice.plane.name;
  if (item.tagExists(DCM_ModalityLUTSequence))
    throw ConfigError("a modality look-up table is not applied", name,
                      "export the series with rescale slope and intercept");
  slice.slope = dicom_numbers(item, DCM_RescaleSlope, 1, name).value_or(std::vector<double>{1.0}).front();
  slice.intercept =
      dicom_numbers(item, DCM_RescaleIntercept, 1, name).value_or(std::vector<double>{0.0}).front();
  if (slice.slope == 0.0 || std::abs(slice.slope) > kScaleMax || std::abs(slice.intercept) > kScaleMax)
    throw ConfigError(
        fmt::format("rescale slope {:g} and intercept {:g} are impossible", slice.slope, slice.intercept),
        name, "export the series again");
}

void read_slices(DcmItem& dataset, DicomFile& file) {
  const std::string name = file.file.string();
  const PixelFormat format = read_pixel_format(dataset, name);
  const bool enhanced = dataset.tagExists(DCM_PerFrameFunctionalGroupsSequence);
  if (file.image_type.find("MOSAIC") != std::string::npos)
    throw ConfigError("a mosaic (many slices tiled into one picture) is not read", name,
                      "export the series as single slices");
  if (format.frames > 1 && !enhanced)
    throw ConfigError(
        fmt::format("{} frames without functional groups (not an enhanced multi-frame image)", format.frames),
        name, "export the series as single slices or as enhanced multi-frame");
  for (int frame = 0; frame < format.frames; ++frame) {
    DicomSlice slice;
    const std::string slice_name = enhanced ? fmt::format("{} (frame {})", name, frame + 1) : name;
    const FrameItems items =
        enhanced ? items_of_frame(dataset, frame, slice_name) : items_of_classic(dataset);
    slice.plane = plane_of(items, format.columns, format.rows, slice_name);
    slice.file = file.file;
    slice.frame = frame;
    if (items.scale) read_scale(*items.scale, slice);
    file.slices.push_back(slice);
  }
}

std::string ascii(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c >= 0x80; }, '?');
  return text;
}

void read_identity(DcmItem& dataset, DicomFile& file) {
  // Everything the program writes is UTF-8; letters that cannot be converted become '?'.
  const bool utf8 =
      dataset.convertToUTF8().good() && dicom_text(dataset, DCM_SpecificCharacterSet) == "ISO_IR 192";
  const auto text = [&](const DcmTagKey& tag) {
    std::string value = dicom_text(dataset, tag);
    return utf8 ? value : ascii(std::move(value));
  };
  SeriesIdentity& identity = file.identity;
  identity.patient_name = text(DCM_PatientName);
  identity.patient_id = text(DCM_PatientID);
  identity.study_uid = ascii(text(DCM_StudyInstanceUID));
  identity.series_uid = ascii(text(DCM_SeriesInstanceUID));
  identity.frame_of_reference_uid = ascii(text(DCM_FrameOfReferenceUID));
  identity.modality = ascii(text(DCM_Modality));
  identity.description = text(DCM_SeriesDescription);
  identity.date = ascii(text(DCM_SeriesDate));
  if (identity.date.empty()) identity.date = ascii(text(DCM_StudyDate));
  file.image_type = dicom_text(dataset, DCM_ImageType);
  file.acquired = dicom_acquisition_time(dataset);
  const auto images = strict_integer(dicom_text(dataset, DCM_ImagesInAcquisition));
  if (images && *images > 0 && *images <= kSizeMax) file.images_in_acquisition = static_cast<int>(*images);
}

// A report, a structure set or a DICOMDIR says so by its class. A file that names no class, or the class of
// an image, and yet has no image size was cut off: it must not pass for "no image", or a stack would get
// shorter in silence.
bool says_it_is_no_image(DcmFileFormat& content) {
  std::string sop_class = dicom_text(*content.getDataset(), DCM_SOPClassUID);
  if (sop_class.empty()) sop_class = dicom_text(*content.getMetaInfo(), DCM_MediaStorageSOPClassUID);
  return !sop_class.empty() && !dcmIsImageStorageSOPClassUID(sop_class.c_str());
}

}  // namespace

bool looks_like_dicom(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  for (const char* dicom : {".dcm", ".DCM", ".ima", ".IMA"})
    if (extension == dicom) return true;
  std::array<char, 132> begin{};
  std::ifstream in(file, std::ios::binary);
  in.read(begin.data(), begin.size());
  const std::streamsize got = in.gcount();
  if (got == 132 && std::string_view(begin.data() + 128, 4) == "DICM") return true;
  // (0008,00xx) in little endian, then a value representation in letters or the length of a short value.
  const bool letters = std::isupper(static_cast<unsigned char>(begin[4])) &&
                       std::isupper(static_cast<unsigned char>(begin[5]));
  const bool short_value =
      static_cast<unsigned char>(begin[4]) < 128 && begin[5] == 0 && begin[6] == 0 && begin[7] == 0;
  return got > 8 && begin[0] == 8 && begin[1] == 0 && begin[3] == 0 && (letters || short_value);
}

DicomFile scan_dicom_file(const std::filesystem::path& path) {
  DicomFile file;
  file.file = path;
  ready_dicom_library();
  DcmFileFormat content;
  const OFCondition loaded = content.loadFileUntilTag(path.c_str(), EXS_Unknown, EGL_noChange,
                                                      DCM_MaxReadLength, ERM_autoDetect, DCM_PixelData);
  DcmItem& dataset = *content.getDataset();
  file.is_image = loaded.good() && dataset.tagExists(DCM_Rows) && dataset.tagExists(DCM_Columns);
  file.readable = loaded.good() && (file.is_image || says_it_is_no_image(content));
  if (!file.readable) {
    file.refusal = ConfigError(fmt::format("cannot be read as DICOM, truncated or damaged ({})",
                                           loaded.bad() ? loaded.text() : "the header ends early"),
                               path.string(), "copy the file again, or take it out of the folder");
    return file;
  }
  try {
    read_identity(dataset, file);
    if (file.is_image) read_slices(dataset, file);
  } catch (const ConfigError& refusal) {
    file.refusal = refusal;
  }
  return file;
}

}  // namespace biopsy::imaging
