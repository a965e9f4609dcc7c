#include "planner/imaging/io/dicom/dicom_reader.hpp"

#include <algorithm>
#include <memory>

#include "planner/imaging/io/dicom/dicom_pixels.hpp"

namespace biopsy::imaging {
namespace {

std::vector<const DicomSlice*> slices_of(const DicomSeries& series) {
  std::vector<const DicomSlice*> slices;
  for (const DicomFile& file : series.files)
    for (const DicomSlice& slice : file.slices) slices.push_back(&slice);
  return slices;
}

// One series, one patient, one session on the table: anything else was put together by mistake.
void refuse_mixture(const DicomFile& first, const DicomFile& file) {
  const std::string both = first.file.string() + " and " + file.file.string();
  const auto refuse = [&](const char* what) {
    throw ConfigError(what, both, "separate the files and export the series again");
  };
  if (first.identity.patient_id != file.identity.patient_id) refuse("two patients in one series");
  if (first.identity.study_uid != file.identity.study_uid) refuse("two studies in one series");
  if (first.identity.frame_of_reference_uid != file.identity.frame_of_reference_uid)
    refuse("two frames of reference in one series");
  if (first.localiser() != file.localiser()) refuse("a localiser (scout) image among the slices of a series");
}

// Decodes slice after slice; a file that holds several is opened once.
class SliceDecoder {
 public:
  void append(const DicomSlice& slice, Volume& volume) {
    if (!pixels_ || slice.file != file_) {
      pixels_ = std::make_unique<DicomPixels>(slice.file);
      file_ = slice.file;
    }
    const PixelFormat& format = pixels_->format();
    if (format.columns != slice.plane.columns || format.rows != slice.plane.rows ||
        slice.frame >= format.frames)
      throw ConfigError("changed while it was read", slice.file.string(),
                        "read again when the export has finished");
    rounded_ |= pixels_->append_frame(slice.frame, slice.slope, slice.intercept, volume.voxels);
    lossy_ |= pixels_->lossy();
  }

  void add_warnings(std::vector<std::string>& warnings) const {
    if (rounded_) warnings.push_back("values above 16777216 are rounded to the precision of a float");
    if (lossy_)
      warnings.push_back("the images were compressed with loss: values may differ from what was measured");
  }

 private:
  std::unique_ptr<DicomPixels> pixels_;
  std::filesystem::path file_;
  bool rounded_ = false, lossy_ = false;
};

}  // namespace

DicomFolder scan_dicom_files(const std::vector<std::filesystem::path>& files) {
  DicomFolder folder;
  for (const std::filesystem::path& path : files) {
    DicomFile file = scan_dicom_file(path);
    if (!file.readable) {
      folder.broken.push_back(std::move(file));
      continue;
    }
    if (!file.is_image) continue;
    auto known = std::find_if(folder.series.begin(), folder.series.end(), [&](const DicomSeries& series) {
      return series.uid == file.identity.series_uid;
    });
    if (known == folder.series.end()) known = folder.series.insert(known, {file.identity.series_uid, {}});
    known->files.push_back(std::move(file));
  }
  return folder;
}

namespace {

std::vector<SlicePlane> planes_of(const DicomSeries& series) {
  for (const DicomFile& file : series.files)
    if (file.refusal) throw *file.refusal;
  for (const DicomFile& file : series.files) refuse_mixture(series.files.front(), file);
  std::vector<SlicePlane> planes;
  for (const DicomSlice* slice : slices_of(series)) planes.push_back(slice->plane);
  return planes;
}

Volume decoded(const DicomSeries& series, const SliceStack& stack) {
  const std::vector<const DicomSlice*> slices = slices_of(series);
  Volume volume;
  volume.grid = stack.grid;
  volume.identity = series.files.front().identity;
  volume.format = "DICOM";
  volume.warnings = stack.warnings;
  SliceDecoder decoder;
  for (const std::size_t n : stack.order) {
    decoder.append(*slices[n], volume);
    const std::string file = slices[n]->file.string();
    if (volume.files.empty() || volume.files.back() != file) volume.files.push_back(file);
  }
  decoder.add_warnings(volume.warnings);
  return volume;
}

}  // namespace

SliceStack stack_series(const DicomSeries& series) {
  return stack_slices(planes_of(series));
}

Volume read_dicom_series(const DicomSeries& series) {
  return decoded(series, stack_series(series));
}

std::vector<SliceStack> slabs_of(const DicomSeries& series) {
  return stack_slabs(planes_of(series));
}

std::vector<Volume> read_dicom_slabs(const DicomSeries& series) {
  std::vector<Volume> volumes;
  for (const SliceStack& stack : slabs_of(series)) volumes.push_back(decoded(series, stack));
  return volumes;
}

std::optional<std::chrono::system_clock::time_point> acquired(const Volume& volume) {
  std::optional<std::chrono::system_clock::time_point> first;
  if (volume.format != "DICOM") return first;
  for (const std::string& file : volume.files) {
    const auto one = scan_dicom_file(file).acquired;
    if (one && (!first || *one < *first)) first = one;
  }
  return first;
}

}  // namespace biopsy::imaging
