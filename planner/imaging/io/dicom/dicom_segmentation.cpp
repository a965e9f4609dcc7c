#include "planner/imaging/io/dicom/dicom_segmentation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planner/imaging/io/dicom/dicom_fields.hpp"
#include "planner/imaging/io/dicom/dicom_frame.hpp"
#include "planner/imaging/io/dicom/dicom_header.hpp"
#include "planner/imaging/io/dicom/segment_pixels.hpp"
#include "planner/imaging/io/segment_labels.hpp"
#include "planner/imaging/io/volume_files.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/common/text/strict_number.hpp"

namespace biopsy::imaging {
namespace {

namespace fs = std::filesystem;

constexpr int kFramesMax = 65'536;
constexpr const char* kLabelMapStorage = "1.2.840.10008.5.1.4.1.1.66.7";  // since 2024, not in DCMTK 3.6

struct SegmentFrame {
  SlicePlane plane;
  int segment = 0;
  int slice = 0;  // from the lowest, in the stack
};

bool is_segmentation(const fs::path& file) {
  DcmFileFormat content;
  if (content
          .loadFileUntilTag(file.c_str(), EXS_Unknown, EGL_noChange, DCM_MaxReadLength, ERM_autoDetect,
                            DCM_PixelData)
          .bad())
    return false;
  const std::string sop_class = dicom_text(*content.getDataset(), DCM_SOPClassUID);
  return sop_class == UID_SegmentationStorage || sop_class == kLabelMapStorage;
}

int count_at(DcmItem& dataset, const DcmTagKey& tag, int most, const std::string& file) {
  const auto number = strict_integer(dicom_text(dataset, tag));
  if (!number || *number < 1 || *number > most)
    refuse_segmentation(fmt::format("{} is not a number from 1 to {}", dicom_tag_name(tag), most), file);
  return static_cast<int>(*number);
}

std::map<int, std::string> segment_names(DcmItem& dataset, SegmentationKind kind, const std::string& file) {
  std::map<int, std::string> names;
  DcmItem* item = nullptr;
  for (int n = 0; dataset.findAndGetSequenceItem(DCM_SegmentSequence, item, n).good() && item != nullptr;
       ++n) {
    const auto number = dicom_unsigned_short(*item, DCM_SegmentNumber);
    if (number == 0 && kind == SegmentationKind::LabelMap) continue;  // the background
    if (number.value_or(0) == 0) refuse_segmentation("a segment has no number", file);
    std::string name = plain(dicom_text(*item, DCM_SegmentLabel));
    if (name.empty()) name = fmt::format("segment {}", *number);
    if (!names.emplace(*number, std::move(name)).second)
      refuse_segmentation(fmt::format("two segments have the number {}", *number), file);
  }
  if (names.empty()) refuse_segmentation("it has no segments", file);
  return names;
}

std::vector<SegmentFrame> segment_frames(DcmItem& dataset, SegmentationKind kind,
                                         const std::map<int, std::string>& names, const std::string& file) {
  const int columns = count_at(dataset, DCM_Columns, kSizeMax, file);
  const int rows = count_at(dataset, DCM_Rows, kSizeMax, file);
  const int count = count_at(dataset, DCM_NumberOfFrames, kFramesMax, file);
  std::vector<SegmentFrame> frames;
  for (int n = 0; n < count; ++n) {
    const std::string name = fmt::format("{} (frame {})", file, n + 1);
    const FrameItems items = items_of_frame(dataset, n, name);
    SegmentFrame frame{.plane = plane_of(items, columns, rows, name)};
    if (items.segment != nullptr)
      frame.segment = dicom_unsigned_short(*items.segment, DCM_ReferencedSegmentNumber).value_or(0);
    if (kind != SegmentationKind::LabelMap && !names.contains(frame.segment))
      refuse_segmentation(fmt::format("the frame is of segment {}, which is not described", frame.segment),
                          name);
    frames.push_back(std::move(frame));
  }
  return frames;
}

// Distance of neighbouring slices: as stated where all frames fit it, else the smallest gap between two.
double slice_gap(const std::vector<double>& heights, const SlicePlane& any) {
  double least = 0.0;
  for (std::size_t n = 1; n < heights.size(); ++n) {
    const double gap = heights[n] - heights[n - 1];
    if (gap > kStackTolerance_mm && (least == 0.0 || gap < least)) least = gap;
  }
  const double stated = any.stated_gap_mm > 0.0 ? any.stated_gap_mm : any.thickness_mm;
  if (least == 0.0) return stated;  // one slice
  const double times = least / any.stated_gap_mm;
  const bool fits = any.stated_gap_mm > 0.0 && times > 0.5 &&
                    std::abs(times - std::round(times)) * any.stated_gap_mm <= kStackTolerance_mm;
  return fits ? any.stated_gap_mm : least;
}

// A slice of several segments has a frame for each.
void refuse_other_planes(const SlicePlane& first, const SlicePlane& plane) {
  if ((first.along_row - plane.along_row).norm() > kDirectionTolerance ||
      (first.along_column - plane.along_column).norm() > kDirectionTolerance ||
      std::abs(first.spacing_i_mm - plane.spacing_i_mm) > 1e-4 * first.spacing_i_mm ||
      std::abs(first.spacing_j_mm - plane.spacing_j_mm) > 1e-4 * first.spacing_j_mm)
    refuse_segmentation("the frame is turned, or of another spacing, than the first", plane.name);
}

// Every slice from the lowest frame to the highest, three at least, and in each frame its number. What lies
// off them is refused by stack_slices, since a frame stands for its slice where there is one.
std::vector<SlicePlane> all_slices(std::vector<SegmentFrame>& frames, const std::string& file) {
  const SlicePlane& any = frames.front().plane;
  const Direction normal = any.along_row.cross(any.along_column).normalized();
  std::vector<double> heights;
  for (const SegmentFrame& frame : frames) {
    refuse_other_planes(any, frame.plane);
    heights.push_back(normal.dot(frame.plane.p_SV));
  }
  std::ranges::sort(heights);
  const double gap_mm = slice_gap(heights, any);
  if (!(gap_mm > 0.0) || !std::isfinite(gap_mm) || !std::isfinite(heights.front()) ||
      !std::isfinite(heights.back()))
    refuse_segmentation("the distance of its slices is not known", file);
  const double reach = (heights.back() - heights.front()) / gap_mm;
  if (!(reach < kSizeMax)) refuse_segmentation(fmt::format("it has more than {} slices", kSizeMax), file);

  const auto lowest = std::ranges::min_element(
      frames, {}, [&](const SegmentFrame& frame) { return normal.dot(frame.plane.p_SV); });
  std::vector<SlicePlane> slices(static_cast<std::size_t>(std::max(3.0, std::round(reach) + 1.0)),
                                 lowest->plane);
  for (std::size_t k = 0; k < slices.size(); ++k) {
    slices[k].p_SV += static_cast<double>(k) * gap_mm * normal;
    slices[k].name = fmt::format("{} (slice {}, empty)", file, k + 1);
  }
  std::vector<bool> taken(slices.size(), false);
  for (SegmentFrame& frame : frames) {
    const double height = (normal.dot(frame.plane.p_SV) - heights.front()) / gap_mm;
    frame.slice = static_cast<int>(std::lround(height));
    const auto k = static_cast<std::size_t>(frame.slice);
    if (taken[k] && (slices[k].p_SV - frame.plane.p_SV).norm() > kStackTolerance_mm)
      refuse_segmentation("two frames of one slice lie beside each other", frame.plane.name);
    if (!taken[k]) slices[k] = frame.plane;
    taken[k] = true;
  }
  return slices;
}

}  // namespace

std::optional<fs::path> dicom_segmentation_at(const fs::path& path) {
  ready_dicom_library();
  std::error_code error;
  if (fs::is_regular_file(path, error))
    return looks_like_dicom(path) && is_segmentation(path) ? std::optional(path) : std::nullopt;
  if (!fs::is_directory(path, error)) return std::nullopt;
  const VolumeFiles files = find_volume_files(path);
  const bool alone =
      files.dicom.size() == 1 && files.nifti.empty() && files.nrrd.empty() && files.metaimage.empty();
  return alone && is_segmentation(files.dicom.front()) ? std::optional(files.dicom.front()) : std::nullopt;
}

LabelMap read_dicom_segmentation(const fs::path& path) {
  const std::string file = path.string();
  ready_dicom_library();
  DcmFileFormat content;
  const OFCondition loaded = content.loadFile(path.c_str());
  if (loaded.bad()) refuse_segmentation(fmt::format("cannot be read as DICOM ({})", loaded.text()), file);
  DcmItem& dataset = *content.getDataset();
  dataset.convertToUTF8();  // what cannot be converted is made plain later
  const SegmentationKind kind = segmentation_kind(dataset, file);
  SegmentLabels labels(segment_names(dataset, kind, file), file);
  const std::map<int, std::string> segments = labels.names();
  std::vector<SegmentFrame> frames = segment_frames(dataset, kind, segments, file);
  const SliceStack stack = stack_slices(all_slices(frames, file));
  std::vector<int> slice_of_plane(stack.order.size());
  for (std::size_t k = 0; k < stack.order.size(); ++k) slice_of_plane[stack.order[k]] = static_cast<int>(k);

  LabelMap map;
  map.ends_unlabelled = true;
  map.volume.grid = stack.grid;
  map.volume.identity = scan_dicom_file(path).identity;
  map.volume.format = "DICOM SEG";
  map.volume.files = {file};
  refuse_large_labels(stack.grid, file);
  const int columns = stack.grid.size.x(), rows = stack.grid.size.y();
  const std::size_t pixels = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  SegmentPixels segment_pixels(dataset, kind, path, pixels, frames.size());
  map.volume.voxels.assign(stack.grid.voxel_count(), 0.0F);
  for (std::size_t n = 0; n < frames.size(); ++n) {
    const std::vector<int>& of_frame = segment_pixels.frame(n, frames[n].segment);
    float* voxels = map.volume.voxels.data() +
                    stack.grid.index(0, 0, slice_of_plane[static_cast<std::size_t>(frames[n].slice)]);
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
      const int segment = of_frame[pixel];
      if (segment == 0) continue;
      if (!segments.contains(segment))
        refuse_segmentation(fmt::format("a pixel is of segment {}, which is not described", segment),
                            frames[n].plane.name);
      voxels[pixel] = static_cast<float>(labels.joined(static_cast<int>(voxels[pixel]), segment));
    }
  }
  map.names = labels.names();
  return map;
}

}  // namespace biopsy::imaging
