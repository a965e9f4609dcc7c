#include "planner/imaging/io/read_volume.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "planner/imaging/io/dicom/plane_series.hpp"
#include "planner/imaging/io/metaimage/metaimage_reader.hpp"
#include "planner/imaging/io/nifti/nifti_reader.hpp"
#include "planner/imaging/io/nrrd/nrrd_reader.hpp"
#include "planner/imaging/io/volume_files.hpp"
#include "robot/common/config_error.hpp"

namespace biopsy::imaging {
namespace {

std::string listed(const std::vector<SeriesSummary>& series) {
  std::string text;
  for (const SeriesSummary& one : series)
    text += fmt::format(
        "\n  {}  \"{}\"  {}", one.series_uid.empty() ? "(no uid)" : one.series_uid, one.description,
        one.problem.empty()
            ? fmt::format("{} x {} x {} at {:.3g} x {:.3g} x {:.3g} mm", one.size.x(), one.size.y(),
                          one.size.z(), one.spacing_mm.x(), one.spacing_mm.y(), one.spacing_mm.z())
            : "cannot be read: " + one.problem);
  return text;
}

// A damaged file could be the end of the chosen series: a stack must not get shorter in silence.
void refuse_broken(const DicomFolder& folder) {
  if (!folder.broken.empty()) throw *folder.broken.front().refusal;
}

enum class Wanted { Volume, Stacks };

// A program that knows nothing of the scanner writes this; so does one that lost what it knew.
void warn_of_default_geometry(Volume& volume) {
  const Eigen::Matrix3d axes = volume.grid.X_SI.linear();
  if (!axes.cwiseAbs().isApprox(Eigen::Matrix3d::Identity(), 1e-9) ||
      !volume.grid.X_SI.translation().isZero(1e-9))
    return;
  volume.warnings.push_back(
      "the geometry is a default (voxels of 1 mm, the first at the scanner's centre, axes along the "
      "patient's): "
      "places in it are probably not those of a scanner");
}

// Planes that were exported as a series each.
std::vector<Volume> read_planes(const std::vector<DicomSeries>& series, const std::filesystem::path& path) {
  std::vector<Volume> planes;
  for (const DicomSeries& one : series)
    for (Volume& stack : read_dicom_slabs(one)) planes.push_back(std::move(stack));
  refuse_taken_apart(planes, path.string());
  return planes;
}

std::vector<Volume> read_series(const std::filesystem::path& path, const std::string& series_uid,
                                Wanted wanted) {
  const VolumeFiles files = find_volume_files(path);
  const DicomFolder folder = scan_dicom_files(files.dicom);
  refuse_broken(folder);
  const std::size_t count =
      folder.series.size() + files.nifti.size() + files.nrrd.size() + files.metaimage.size();
  if (count == 0)
    throw ConfigError("DICOM, but no image (a report, structure set or directory)", path.string(),
                      "give an image series");
  if (series_uid.empty() && wanted == Wanted::Stacks && count == folder.series.size() &&
      are_planes(folder.series))
    return read_planes(folder.series, path);
  if (series_uid.empty() && count > 1)
    throw ConfigError(fmt::format("{} series:{}", count, listed(list_series(path))), path.string(),
                      "choose one of them with --series UID");

  const int slices_min = wanted == Wanted::Stacks ? 1 : kSizeMin;
  const auto chosen = [&](const std::string& uid) { return series_uid.empty() || uid == series_uid; };
  const auto name_of = [&](const std::filesystem::path& file) {
    return (file == path ? file.filename() : file.lexically_relative(path)).generic_string();
  };
  for (const DicomSeries& series : folder.series)
    if (chosen(series.uid)) {
      if (wanted == Wanted::Stacks) return read_dicom_slabs(series);
      return {read_dicom_series(series)};
    }
  for (const auto& file : files.nifti)
    if (chosen(name_of(file))) return {read_nifti(file, slices_min)};
  for (const auto& file : files.nrrd)
    if (chosen(name_of(file))) return {read_nrrd(file, slices_min)};
  for (const auto& file : files.metaimage)
    if (chosen(name_of(file))) return {read_metaimage(file, slices_min)};
  throw ConfigError(fmt::format("no series \"{}\" here, only:{}", series_uid, listed(list_series(path))),
                    path.string(), "choose one of them with --series UID");
}

}  // namespace

Volume read_volume(const std::filesystem::path& path, const std::string& series_uid) {
  Volume volume = std::move(read_series(path, series_uid, Wanted::Volume).front());
  warn_of_default_geometry(volume);
  return volume;
}

std::vector<Volume> read_stacks(const std::filesystem::path& path, const std::string& series_uid) {
  std::vector<Volume> stacks = read_series(path, series_uid, Wanted::Stacks);
  for (Volume& stack : stacks) warn_of_default_geometry(stack);
  return stacks;
}

}  // namespace biopsy::imaging
