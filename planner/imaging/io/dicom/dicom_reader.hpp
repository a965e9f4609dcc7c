// Series of DICOM images, from files to volumes.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planner/imaging/io/dicom/dicom_header.hpp"

namespace biopsy::imaging {

struct DicomSeries {
  std::string uid;  // SeriesInstanceUID
  std::vector<DicomFile> files;
};

struct DicomFolder {
  std::vector<DicomSeries> series;  // images only, in the order of the first file of each
  std::vector<DicomFile> broken;    // damaged beyond knowing their series
};

DicomFolder scan_dicom_files(const std::vector<std::filesystem::path>& files);

// Throws ConfigError when the series is not one volume: a file refused, two patients or frames of reference,
// a scout among slices, or what stack_slices refuses.
SliceStack stack_series(const DicomSeries& series);

// The volume: right-handed, slices along rising position on the normal; identity from the first slice;
// warnings for contradicting spacings and lossy compression. Throws ConfigError as stack_series and
// DicomPixels do.
Volume read_dicom_series(const DicomSeries& series);

// One stack for each orientation in the series, of any number of slices; see stack_slabs.
std::vector<SliceStack> slabs_of(const DicomSeries& series);
std::vector<Volume> read_dicom_slabs(const DicomSeries& series);

// When the first slice of a volume that was read from DICOM files was acquired, by the scanner's clock; none
// where its files do not say, or are gone.
std::optional<std::chrono::system_clock::time_point> acquired(const Volume& volume);

}  // namespace biopsy::imaging
