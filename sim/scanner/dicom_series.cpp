#include "sim/scanner/dicom_series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include "robot/common/config_error.hpp"
#include "sim/scanner/dicom_elements.hpp"

namespace biopsy::sim {
namespace {

constexpr const char* kMrImageStorage = "1.2.840.10008.5.1.4.1.1.4";
constexpr const char* kExplicitLittleEndian = "1.2.840.10008.1.2.1";
constexpr const char* kImplementationClass =
    "2.25.271828182845904523536028747135266249";  // fixed for this writer
constexpr const char* kImplementationName = "BIOPSY_SIM_1";

// FNV-1a over 64 bits (RFC draft eastlake-fnv): no secret is kept, the same content must only give the same
// name.
class ContentHash {
 public:
  ContentHash& add(const void* data, std::size_t count) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t n = 0; n < count; ++n) state_ = (state_ ^ bytes[n]) * 0x100000001b3ULL;
    return *this;
  }
  ContentHash& add(const std::string& text) {
    return add(text.c_str(), text.size() + 1);
  }                                                                   // the zero ends the word
  std::string uid() const { return fmt::format("2.25.{}", state_); }  // PS3.5 B.2

 private:
  std::uint64_t state_ = 0xcbf29ce484222325ULL;
};

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
  ContentHash content;
  content.add(volume.grid.size.data(), sizeof(int) * 3).add(volume.grid.X_SI.data(), sizeof(double) * 16);
  content.add(volume.voxels.data(), sizeof(float) * volume.voxels.size());
  content.add(identity.patient_id).add(identity.patient_name).add(identity.description).add(identity.date);
  const auto complete = [&](std::string& uid, const char* role) {
    if (!is_uid(uid)) uid = ContentHash(content).add(std::string(role)).add(uid).uid();
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
  ContentHash hash;
  hash.add(series_uid).add(std::to_string(k)).add(grid.X_SI.data(), sizeof(double) * 16);
  hash.add(&volume.voxels[grid.index(0, 0, k)],
           sizeof(float) * (grid.index(0, 0, k + 1) - grid.index(0, 0, k)));
  return hash.uid();
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

std::string file_header(const std::string& instance_uid) {
  DicomElements meta;
  meta.bytes(0x00020001, "OB", std::string_view("\0\1", 2));
  meta.text(0x00020002, "UI", kMrImageStorage);
  meta.text(0x00020003, "UI", instance_uid);
  meta.text(0x00020010, "UI", kExplicitLittleEndian);
  meta.text(0x00020012, "UI", kImplementationClass);
  meta.text(0x00020013, "SH", kImplementationName);
  DicomElements length;
  length.unsigned_long(0x00020000, static_cast<std::uint32_t>(meta.encoded().size()));
  return std::string(128, '\0').append("DICM").append(length.encoded()).append(meta.encoded());
}

void put_identity(const SeriesIdentity& identity, const std::string& instance_uid, DicomElements& out) {
  out.text(0x00080005, "CS", "ISO_IR 192");
  out.text(0x00080008, "CS", "DERIVED\\PRIMARY\\OTHER");  // made by a program from a model
  out.text(0x00080016, "UI", kMrImageStorage);
  out.text(0x00080018, "UI", instance_uid);
  out.text(0x00080020, "DA", identity.date);  // study date, series date
  out.text(0x00080021, "DA", identity.date);
  out.text(0x00080030, "TM", "");
  out.text(0x00080050, "SH", "");
  out.text(0x00080060, "CS", "MR");
  out.text(0x00080070, "LO", "simulated");
  out.text(0x00080090, "PN", "");
  out.text(0x0008103e, "LO", identity.description);
  out.text(0x00100010, "PN", identity.patient_name);
  out.text(0x00100020, "LO", identity.patient_id);
  out.text(0x00100030, "DA", "");
  out.text(0x00100040, "CS", "");
}

void put_geometry(const Grid& grid, int k, int number, const SeriesIdentity& identity, DicomElements& out) {
  const Eigen::Vector3d spacing = grid.spacing_mm();
  const Eigen::Vector3d row = grid.X_SI.linear().col(0) / spacing.x(),
                        column = grid.X_SI.linear().col(1) / spacing.y();
  const Point p_SV = grid.X_SI * Point(0, 0, k);
  const auto joined = [](std::initializer_list<double> numbers) {
    std::string text;
    for (const double value : numbers) text += (text.empty() ? "" : "\\") + decimal_string(value);
    return text;
  };
  out.text(0x00180020, "CS", "RM");  // scanning sequence: research mode
  out.text(0x00180021, "CS", "NONE");
  out.text(0x00180022, "CS", "");
  out.text(0x00180023, "CS", "2D");
  out.text(0x00180050, "DS", decimal_string(spacing.z()));
  out.text(0x00180080, "DS", "");
  out.text(0x00180081, "DS", "");
  out.text(0x00180088, "DS", decimal_string(spacing.z()));
  out.text(0x00180091, "IS", "");
  out.text(0x0020000d, "UI", identity.study_uid);
  out.text(0x0020000e, "UI", identity.series_uid);
  out.text(0x00200010, "SH", "");
  out.text(0x00200011, "IS", "1");
  out.text(0x00200013, "IS", std::to_string(number));
  out.text(0x00200032, "DS", joined({p_SV.x(), p_SV.y(), p_SV.z()}));
  out.text(0x00200037, "DS", joined({row.x(), row.y(), row.z(), column.x(), column.y(), column.z()}));
  out.text(0x00200052, "UI", identity.frame_of_reference_uid);
  out.text(0x00201040, "LO", "");
}

void put_pixels(const Volume& volume, int k, const Storage& storage, DicomElements& out) {
  const Grid& grid = volume.grid;
  const Eigen::Vector3d spacing = grid.spacing_mm();
  out.unsigned_short(0x00280002, 1);
  out.text(0x00280004, "CS", "MONOCHROME2");
  out.unsigned_short(0x00280010, static_cast<std::uint16_t>(grid.size.y()));  // rows
  out.unsigned_short(0x00280011, static_cast<std::uint16_t>(grid.size.x()));  // columns
  out.text(0x00280030, "DS",
           decimal_string(spacing.y()) + "\\" + decimal_string(spacing.x()));  // between rows first
  out.unsigned_short(0x00280100, 16);
  out.unsigned_short(0x00280101, 16);
  out.unsigned_short(0x00280102, 15);
  out.unsigned_short(0x00280103, storage.is_signed ? 1 : 0);
  out.text(0x00281052, "DS", storage.intercept);
  out.text(0x00281053, "DS", storage.slope);
  const auto first = volume.voxels.begin() + static_cast<std::ptrdiff_t>(grid.index(0, 0, k));
  std::vector<std::uint16_t> words(static_cast<std::size_t>(grid.size.x()) *
                                   static_cast<std::size_t>(grid.size.y()));
  std::transform(first, first + static_cast<std::ptrdiff_t>(words.size()), words.begin(),
                 [&](float value) { return storage.stored(value); });
  out.words(0x7fe00010, words);
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
    DicomElements out;
    put_identity(identity, instance_uid, out);
    put_geometry(volume.grid, k, number, identity, out);
    put_pixels(volume, k, storage, out);
    files.push_back(folder / fmt::format("slice_{:04}.dcm", number));
    std::ofstream file(files.back(), std::ios::binary);
    file << file_header(instance_uid) << out.encoded();
    if (!file.flush())
      throw ConfigError("cannot be written", files.back().string(),
                        "check the space left and the permissions");
  }
  return files;
}

}  // namespace biopsy::sim
