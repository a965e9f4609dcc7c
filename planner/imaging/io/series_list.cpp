#include "planner/imaging/io/series_list.hpp"

#include "planner/imaging/io/dicom/dicom_reader.hpp"
#include "planner/imaging/io/metaimage/metaimage_reader.hpp"
#include "planner/imaging/io/nifti/nifti_reader.hpp"
#include "planner/imaging/io/nrrd/nrrd_reader.hpp"
#include "planner/imaging/io/volume_files.hpp"

namespace biopsy::imaging {
namespace {

void take_grid(const Grid& grid, SeriesSummary& summary) {
  summary.size = grid.size;
  summary.spacing_mm = grid.spacing_mm();
  summary.slices = grid.size.z();
}

SeriesSummary summary_of(const DicomSeries& series) {
  const SeriesIdentity& identity = series.files.front().identity;
  SeriesSummary summary;
  summary.series_uid = series.uid;
  summary.description = identity.description;
  summary.modality = identity.modality;
  summary.format = "DICOM";
  for (const DicomFile& file : series.files) {
    summary.slices += static_cast<int>(file.slices.size());
    summary.files.push_back(file.file.string());
  }
  try {
    take_grid(stack_series(series).grid, summary);
  } catch (const ConfigError& refusal) {
    summary.problem = refusal.what();
  }
  return summary;
}

SeriesSummary summary_of_broken(const DicomFile& file) {
  SeriesSummary summary;
  summary.format = "DICOM";
  summary.files = {file.file.string()};
  summary.problem = file.refusal->what();
  return summary;
}

SeriesSummary summary_of_file(const std::filesystem::path& file, const std::filesystem::path& root,
                              const char* format, Volume (*read_header)(const std::filesystem::path&)) {
  SeriesSummary summary;
  summary.series_uid = (file == root ? file.filename() : file.lexically_relative(root)).generic_string();
  summary.format = format;
  summary.files = {file.string()};
  try {
    const Volume header = read_header(file);
    take_grid(header.grid, summary);
    summary.files = header.files;
  } catch (const ConfigError& refusal) {
    summary.problem = refusal.what();
  }
  return summary;
}

}  // namespace

std::vector<SeriesSummary> list_series(const std::filesystem::path& path) {
  const VolumeFiles files = find_volume_files(path);
  std::vector<SeriesSummary> summaries;
  const DicomFolder folder = scan_dicom_files(files.dicom);
  for (const DicomSeries& series : folder.series) summaries.push_back(summary_of(series));
  for (const DicomFile& file : folder.broken) summaries.push_back(summary_of_broken(file));
  for (const auto& file : files.nifti)
    summaries.push_back(summary_of_file(file, path, "NIfTI", read_nifti_header));
  for (const auto& file : files.nrrd)
    summaries.push_back(summary_of_file(file, path, "NRRD", read_nrrd_header));
  for (const auto& file : files.metaimage)
    summaries.push_back(summary_of_file(file, path, "MetaImage", read_metaimage_header));
  return summaries;
}

}  // namespace biopsy::imaging
