#include "planner/imaging/io/dicom/plane_series.hpp"

#include <algorithm>
#include <cmath>

namespace biopsy::imaging {
namespace {

// Planes through a needle may be turned about it by any angle, a repeated one is hardly turned at all.
constexpr double kTurnMin_deg = 20.0;

Direction normal_of(const DicomSeries& series) {
  const SlicePlane& plane = series.files.front().slices.front().plane;
  return plane.along_row.cross(plane.along_column).normalized();
}

}  // namespace

bool is_plane(const DicomSeries& series) {
  std::size_t slices = 0;
  for (const DicomFile& file : series.files) slices += file.slices.size();
  if (slices > kPlaneSlicesMax) return false;
  try {
    return slabs_of(series).size() == 1;
  } catch (const ConfigError&) {
    return false;
  }
}

bool in_other_planes(const DicomSeries& a, const DicomSeries& b) {
  return std::abs(normal_of(a).dot(normal_of(b))) < std::cos(kTurnMin_deg * EIGEN_PI / 180.0);
}

std::string taken_apart(const SeriesIdentity& a, const SeriesIdentity& b) {
  if (stated_otherwise(a.patient_id, b.patient_id)) return "two patients";
  if (stated_otherwise(a.study_uid, b.study_uid)) return "two studies";
  if (stated_otherwise(a.frame_of_reference_uid, b.frame_of_reference_uid)) return "two frames of reference";
  return {};
}

void refuse_taken_apart(std::span<const Volume> images, const std::string& where) {
  for (const Volume& image : images)
    if (const std::string apart = taken_apart(images.front().identity, image.identity); !apart.empty())
      throw ConfigError(apart + " in the planes of one image", where,
                        "give planes that were taken together, one after another");
}

bool are_planes(std::span<const DicomSeries> series) {
  if (series.size() < 2 || series.size() > kPlanesMax || !std::ranges::all_of(series, is_plane)) return false;
  for (std::size_t n = 1; n < series.size(); ++n)
    for (std::size_t m = 0; m < n; ++m)
      if (!in_other_planes(series[n], series[m])) return false;
  return true;
}

}  // namespace biopsy::imaging
