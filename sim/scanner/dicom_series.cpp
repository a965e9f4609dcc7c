#include "sim/scanner/dicom_series.hpp"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "robot/common/config_error.hpp"
#include "sim/scanner/content_uid.hpp"

namespace biopsy::sim {
namespace {

bool is_uid(const std::string& text) {
  return !text.empty() && text.size() <= 64 && text.front() != '.' && text.back() != '.' &&
         text.find_first_not_of("0123456789.") == std::string::npos && text.find("..") == std::string::npos;
}

// A value of one line and one part, at most 64 bytes.
std::string short_text(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == '\\'; }, '/');
  if (text.size() <= 64) return text;
  text.resize(64);
  while (!text.empty() && (text.back() & 0x80)) text.pop_back();  // no half letters of UTF-8
  return text;
}

SeriesIdentity complete_identity(const Volume& volume) {
  SeriesIdentity identity = volume.identity;
  ContentUid content;
  content.add(volume.grid.size.data(), sizeof(int) * 3).add(volume.grid.X_SI.data(), sizeof(double) * 16);
  content.add(volume.voxels.data(), sizeof(float) * volume.voxels.size());
  content.add(identity.patient_id).add(identity.patient_name).add(identity.description).add(identity.date);
  const auto complete = [&](std::string& uid, const char* role) {
    if (!is_uid(uid)) uid = ContentUid(content).add(std::string(role)).add(uid).uid();
  };
  complete(identity.study_uid, "study");
  complete(identity.series_uid, "series");
  complete(identity.frame_of_reference_uid, "frame of reference");
  identity.patient_name = short_text(identity.patient_name);
  identity.patient_id = short_text(identity.patient_id);
  identity.description = short_text(identity.description);
  const bool date =
      identity.date.size() == 8 && identity.date.find_first_not_of("0123456789") == std::string::npos;
  if (!date) identity.date.clear();
  return identity;
}

// Same series, other content or another place: another instance.
std::string instance_uid_of(const Volume& volume, int k, const std::string& series_uid) {
  const Grid& grid = volume.grid;
  ContentUid hash;
  hash.add(series_uid).add(std::to_string(k)).add(grid.X_SI.data(), sizeof(double) * 16);
  hash.add(&volume.voxels[grid.index(0, 0, k)],
           sizeof(float) * (grid.index(0, 0, k + 1) - grid.index(0, 0, k)));
  return hash.uid();
}

// The most exact decimal string (DS, PS3.5 6.2): at most 16 characters, 1e-11 mm for positions in a scanner.
std::string decimal_string(double value) {
  if (std::abs(value) < 1e-13) return "0";  // what is left of a rotation's zero
  for (int digits = 16; digits > 1; --digits) {
    std::string text = fmt::format("{:.{}g}", value, digits);
    if (text.size() <= 16) return text;
  }
  return fmt::format("{:.1g}", value);
}

// How voxels become 16-bit words.
struct Storage {
  bool is_signed = false;
  std::string slope = "1", intercept = "0";             // as written
  double written_slope = 1.0, written_intercept = 0.0;  // their values: the reader has no others

  std::uint16_t stored(float value) const {
    const double steps = std::round((value - written_intercept) / written_slope);
    if (is_signed) return static_cast<std::uint16_t>(static_cast<std::int16_t>(steps));
    return static_cast<std::uint16_t>(std::clamp(steps, 0.0, 65535.0));
  }
};

Storage choose_storage(const std::vector<float>& voxels) {
  const auto [low, high] = std::minmax_element(voxels.begin(), voxels.end());
  const bool whole =
      std::all_of(voxels.begin(), voxels.end(), [](float value) { return value == std::floor(value); });
  Storage storage;
  if (whole && *low >= -32768.0F && *high <= 32767.0F) {
    storage.is_signed = true;
  } else if (!whole || *low < 0.0F || *high > 65535.0F) {
    storage.slope = decimal_string((static_cast<double>(*high) - *low) / 65535.0);
    storage.intercept = decimal_string(*low);
    if (*high <= *low) storage.slope = "1";  // one value everywhere: it is the intercept
    std::from_chars(storage.slope.data(), storage.slope.data() + storage.slope.size(), storage.written_slope);
    std::from_chars(storage.intercept.data(), storage.intercept.data() + storage.intercept.size(),
                    storage.written_intercept);
  }
  return storage;
}

void refuse_unwritable(const Volume& volume, const std::filesystem::path& folder) {
  const std::string where = folder.string();
  const Grid& grid = volume.grid;
  if (grid.size.minCoeff() < 1 || grid.size.maxCoeff() > 65535 || volume.voxels.size() != grid.voxel_count())
    throw ConfigError("the volume has no voxels, or not as many as its size says", where,
                      "give a complete volume");
  if (!std::all_of(volume.voxels.begin(), volume.voxels.end(),
                   [](float value) { return std::isfinite(value); }))
    throw ConfigError("a voxel is not finite", where, "give a volume of finite numbers");
  const Eigen::Matrix3d axes = grid.X_SI.linear().colwise().normalized();
  if (!((axes.transpose() * axes - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-6))
    throw ConfigError("the axes of the volume are not perpendicular", where, "resample the volume first");
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    if (at->path().extension() == ".dcm")
      throw ConfigError("the folder already holds DICOM files", where,
                        "give an empty folder: two series must not mix");
  if (error) throw ConfigError("cannot be written: " + error.message(), where, "check the permissions");
}

void put(DcmItem& out, std::initializer_list<std::pair<DcmTagKey, std::string>> texts) {
  for (const auto& [tag, text] : texts) out.putAndInsertString(tag, text.c_str());
}

void put(DcmItem& out, std::initializer_list<std::pair<DcmTagKey, int>> numbers) {
  for (const auto& [tag, number] : numbers) out.putAndInsertUint16(tag, static_cast<Uint16>(number));
}

std::string joined(std::initializer_list<double> numbers) {
  std::string text;
  for (const double value : numbers) text += (text.empty() ? "" : "\\") + decimal_string(value);
  return text;
}

// Attributes of type 2 (PS3.5, 7.4.3) that nothing is known of are there and empty.
void put_identity(const SeriesIdentity& identity, const std::string& instance_uid, DcmItem& out) {
  put(out, {{DCM_SpecificCharacterSet, "ISO_IR 192"},
            {DCM_ImageType, "DERIVED\\SECONDARY\\OTHER"},
            {DCM_SOPClassUID, UID_MRImageStorage},
            {DCM_SOPInstanceUID, instance_uid},
            {DCM_StudyDate, identity.date},
            {DCM_SeriesDate, identity.date},
            {DCM_StudyTime, ""},
            {DCM_AccessionNumber, ""},
            {DCM_Modality, "MR"},
            {DCM_Manufacturer, "simulated"},
            {DCM_ReferringPhysicianName, ""},
            {DCM_SeriesDescription, identity.description},
            {DCM_PatientName, identity.patient_name},
            {DCM_PatientID, identity.patient_id},
            {DCM_PatientBirthDate, ""},
            {DCM_PatientSex, ""},
            {DCM_StudyInstanceUID, identity.study_uid},
            {DCM_SeriesInstanceUID, identity.series_uid},
            {DCM_StudyID, ""},
            {DCM_SeriesNumber, "1"},
            {DCM_FrameOfReferenceUID, identity.frame_of_reference_uid},
            {DCM_PositionReferenceIndicator, ""}});
}

void put_geometry(const Grid& grid, int k, int number, DcmItem& out) {
  const Eigen::Vector3d spacing = grid.spacing_mm();
  const Eigen::Vector3d row = grid.X_SI.linear().col(0) / spacing.x(),
                        column = grid.X_SI.linear().col(1) / spacing.y();
  const Point p_SV = grid.X_SI * Point(0, 0, k);
  put(out,
      {{DCM_ScanningSequence, "RM"},  // research mode
       {DCM_SequenceVariant, "NONE"},
       {DCM_ScanOptions, ""},
       {DCM_MRAcquisitionType, "2D"},
       {DCM_SliceThickness, decimal_string(spacing.z())},
       {DCM_RepetitionTime, ""},
       {DCM_EchoTime, ""},
       {DCM_SpacingBetweenSlices, decimal_string(spacing.z())},
       {DCM_EchoTrainLength, ""},
       {DCM_InstanceNumber, std::to_string(number)},
       {DCM_ImagePositionPatient, joined({p_SV.x(), p_SV.y(), p_SV.z()})},
       {DCM_ImageOrientationPatient, joined({row.x(), row.y(), row.z(), column.x(), column.y(), column.z()})},
       {DCM_PixelSpacing, joined({spacing.y(), spacing.x()})}});  // between rows first
}

void put_pixels(const Volume& volume, int k, const Storage& storage, DcmItem& out) {
  const Grid& grid = volume.grid;
  put(out, {{DCM_PhotometricInterpretation, "MONOCHROME2"},
            {DCM_RescaleIntercept, storage.intercept},
            {DCM_RescaleSlope, storage.slope}});
  put(out, {{DCM_SamplesPerPixel, 1},
            {DCM_Rows, grid.size.y()},
            {DCM_Columns, grid.size.x()},
            {DCM_BitsAllocated, 16},
            {DCM_BitsStored, 16},
            {DCM_HighBit, 15},
            {DCM_PixelRepresentation, storage.is_signed ? 1 : 0}});
  const auto first = volume.voxels.begin() + static_cast<std::ptrdiff_t>(grid.index(0, 0, k));
  std::vector<Uint16> words(static_cast<std::size_t>(grid.size.x()) *
                            static_cast<std::size_t>(grid.size.y()));
  std::transform(first, first + static_cast<std::ptrdiff_t>(words.size()), words.begin(),
                 [&](float value) { return storage.stored(value); });
  out.putAndInsertUint16Array(DCM_PixelData, words.data(), words.size());
}

}  // namespace

std::vector<std::filesystem::path> write_dicom_series(const Volume& volume,
                                                      const std::filesystem::path& folder) {
  refuse_unwritable(volume, folder);
  const SeriesIdentity identity = complete_identity(volume);
  const Storage storage = choose_storage(volume.voxels);
  const bool left_handed = volume.grid.X_SI.linear().determinant() < 0.0;
  const int slices = volume.grid.size.z();
  std::vector<std::filesystem::path> files;
  for (int number = 1; number <= slices; ++number) {
    const int k = left_handed ? slices - number : number - 1;
    const std::string instance_uid = instance_uid_of(volume, k, identity.series_uid);
    DcmFileFormat content;
    put_identity(identity, instance_uid, *content.getDataset());
    put_geometry(volume.grid, k, number, *content.getDataset());
    put_pixels(volume, k, storage, *content.getDataset());
    files.push_back(folder / fmt::format("slice_{:04}.dcm", number));
    const OFCondition saved = content.saveFile(files.back().c_str(), EXS_LittleEndianExplicit);
    if (saved.bad())
      throw ConfigError(fmt::format("cannot be written: {}", saved.text()), files.back().string(),
                        "check the space left and the permissions");
  }
  return files;
}

}  // namespace biopsy::sim
