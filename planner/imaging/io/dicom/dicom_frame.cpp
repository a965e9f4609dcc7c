#include "planner/imaging/io/dicom/dicom_frame.hpp"

#include "planner/imaging/io/dicom/dicom_fields.hpp"
#include "robot/common/config_error.hpp"

namespace biopsy::imaging {

FrameItems items_of_classic(DcmItem& dataset) {
  return {&dataset, &dataset, &dataset, &dataset, nullptr};
}

FrameItems items_of_frame(DcmItem& dataset, int frame, const std::string& name) {
  DcmItem* own = nullptr;
  if (dataset.findAndGetSequenceItem(DCM_PerFrameFunctionalGroupsSequence, own, frame).bad() || !own)
    throw ConfigError("the functional groups of this frame are missing", name, "export the series again");
  DcmItem* shared = dicom_first_item(dataset, DCM_SharedFunctionalGroupsSequence);
  const auto group = [&](const DcmTagKey& sequence) {
    DcmItem* found = dicom_first_item(*own, sequence);
    return !found && shared ? dicom_first_item(*shared, sequence) : found;
  };
  const FrameItems items = {group(DCM_PlanePositionSequence), group(DCM_PlaneOrientationSequence),
                            group(DCM_PixelMeasuresSequence), group(DCM_PixelValueTransformationSequence),
                            group(DCM_SegmentIdentificationSequence)};
  if (!items.position || !items.orientation || !items.measures)
    throw ConfigError(
        "plane position, plane orientation or pixel measures are missing from the functional groups", name,
        "export the series as classic single-frame images");
  return items;
}

namespace {

double number_to_compare(DcmItem& item, const DcmTagKey& tag, const std::string& name) {
  return dicom_numbers(item, tag, 1, name).value_or(std::vector<double>{0.0}).front();
}

}  // namespace

SlicePlane plane_of(const FrameItems& items, int columns, int rows, const std::string& name) {
  SlicePlane plane;
  plane.name = name;
  plane.columns = columns;
  plane.rows = rows;
  const auto position = required_dicom_numbers(*items.position, DCM_ImagePositionPatient, 3, name);
  const auto orientation = required_dicom_numbers(*items.orientation, DCM_ImageOrientationPatient, 6, name);
  const auto spacing = required_dicom_numbers(*items.measures, DCM_PixelSpacing, 2, name);
  plane.p_SV = Eigen::Map<const Eigen::Vector3d>(position.data());
  plane.along_row = Eigen::Map<const Eigen::Vector3d>(orientation.data());
  plane.along_column = Eigen::Map<const Eigen::Vector3d>(orientation.data() + 3);
  plane.spacing_j_mm = spacing[0];  // PS3.3 10.7.1.3: first between rows, then between columns
  plane.spacing_i_mm = spacing[1];
  plane.stated_gap_mm = number_to_compare(*items.measures, DCM_SpacingBetweenSlices, name);
  plane.thickness_mm = number_to_compare(*items.measures, DCM_SliceThickness, name);
  return plane;
}

}  // namespace biopsy::imaging
