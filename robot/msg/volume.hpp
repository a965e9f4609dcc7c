// A volume of scalar voxels with its geometry in the scanner frame and its origin.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "robot/common/frames.hpp"

namespace biopsy {

// Size in voxels and the map from voxel index (i, j, k) to scanner LPS mm. Axes are perpendicular (checked by
// the readers); a left-handed index order is allowed.
struct Grid {
  Eigen::Vector3i size = Eigen::Vector3i::Zero();
  AffineTransform X_SI = AffineTransform::Identity();

  Eigen::Vector3d spacing_mm() const { return X_SI.linear().colwise().norm().transpose(); }
  std::size_t voxel_count() const {
    return static_cast<std::size_t>(size.x()) * static_cast<std::size_t>(size.y()) *
           static_cast<std::size_t>(size.z());
  }
  std::size_t index(int i, int j, int k) const {
    return static_cast<std::size_t>(i) +
           static_cast<std::size_t>(size.x()) *
               (static_cast<std::size_t>(j) +
                static_cast<std::size_t>(size.y()) * static_cast<std::size_t>(k));
  }
  bool contains(int i, int j, int k) const {
    return i >= 0 && j >= 0 && k >= 0 && i < size.x() && j < size.y() && k < size.z();
  }
};

// Patient and series; empty where the format has no such fields (NIfTI, NRRD).
struct SeriesIdentity {
  std::string patient_name, patient_id;
  std::string study_uid, series_uid, frame_of_reference_uid;
  std::string modality, description, date;
};

// Whether both files state something of a patient, study or frame of reference, and not the same.
inline bool stated_otherwise(const std::string& one, const std::string& other) {
  return !one.empty() && !other.empty() && one != other;
}

struct Volume {
  Grid grid;
  std::vector<float>
      voxels;  // i fastest, then j, then k; in the file's real-world units (slope and intercept applied)
  SeriesIdentity identity;
  std::string format;                 // "DICOM", "NIfTI", "NRRD", "phantom"
  std::vector<std::string> files;     // in slice order
  std::vector<std::string> warnings;  // unusual, but read without ambiguity

  float at(int i, int j, int k) const { return voxels[grid.index(i, j, k)]; }
};

}  // namespace biopsy
