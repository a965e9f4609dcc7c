#include "planner/imaging/io/watched_folder.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "planner/imaging/io/dicom/dicom_reader.hpp"
#include "planner/imaging/io/grid_rules.hpp"
#include "planner/imaging/io/read_volume.hpp"
#include "planner/imaging/io/volume_files.hpp"
#include "robot/common/config_error.hpp"

namespace biopsy::imaging {
namespace fs = std::filesystem;

namespace {

IncomingSeries incoming_of(const DicomSeries& series) {
  IncomingSeries incoming;
  int slices = 0, stated = 0;
  for (const DicomFile& file : series.files) {
    incoming.files.push_back(file.file);
    slices += static_cast<int>(file.slices.size());
    stated = std::max(stated, file.images_in_acquisition);
    if (file.acquired && (!incoming.acquired || *file.acquired < *incoming.acquired))
      incoming.acquired = file.acquired;
  }
  incoming.identity = series.files.front().identity;
  incoming.image_type = series.files.front().image_type;
  try {
    const std::vector<SliceStack> stacks = slabs_of(series);
    incoming.may_go_on = stated == 0 && (stacks.size() > 1 || slices < kSizeMin);
    if (stated > slices) incoming.problem = fmt::format("{} of {} slices have arrived", slices, stated);
  } catch (const ConfigError& refusal) {
    incoming.problem = refusal.what();
  }
  return incoming;
}

IncomingSeries incoming_of(const fs::path& file) {
  IncomingSeries incoming;
  incoming.files = {file};
  try {
    const auto summary = list_series(file);
    incoming.problem = summary.empty() ? "no image" : summary.front().problem;
  } catch (const ConfigError& refusal) {
    incoming.problem = refusal.what();
  }
  return incoming;
}

// All series of which at least one file is new.
std::vector<IncomingSeries> series_among(const VolumeFiles& files) {
  std::vector<IncomingSeries> all;
  const DicomFolder folder = scan_dicom_files(files.dicom);
  for (const DicomSeries& series : folder.series) all.push_back(incoming_of(series));
  for (const DicomFile& file : folder.broken) {
    all.emplace_back();
    all.back().files = {file.file};
    all.back().problem = file.refusal->what();
  }
  for (const auto* others : {&files.nifti, &files.nrrd, &files.metaimage})
    for (const fs::path& file : *others) all.push_back(incoming_of(file));
  return all;
}

}  // namespace

WatchedFolder::WatchedFolder(fs::path folder, std::chrono::milliseconds quiet)
    : folder_(std::move(folder)), quiet_(quiet) {
  if (!fs::is_directory(folder_))
    throw ConfigError("there is no such folder", folder_.string(),
                      "give the folder into which the scanner exports its series");
  past_ = list();
  seen_ = past_;
}

WatchedFolder::Listing WatchedFolder::list() const {
  Listing files;
  std::error_code error;
  fs::recursive_directory_iterator at(folder_, error);
  for (; !error && at != fs::recursive_directory_iterator(); at.increment(error)) {
    std::error_code vanished;  // an export may rename its files at the end
    if (!at->is_regular_file(vanished)) continue;
    const Stamp stamp{at->file_size(vanished), at->last_write_time(vanished)};
    if (!vanished) files.emplace(at->path(), stamp);
  }
  if (error)
    throw ConfigError("cannot be read: " + error.message(), folder_.string(), "check the permissions");
  return files;
}

std::optional<IncomingSeries> WatchedFolder::poll(std::chrono::steady_clock::time_point now) {
  Listing files = list();
  if (files != seen_ || !changed_) {
    seen_ = std::move(files);
    changed_ = now;
    return std::nullopt;
  }
  const auto still = now - *changed_;
  if (still < quiet_) return std::nullopt;
  VolumeFiles fresh;
  for (const auto& [file, stamp] : seen_) {
    const auto known = past_.find(file);
    if (known == past_.end() || known->second != stamp) add_volume_file(file, fresh);
  }
  for (IncomingSeries& series : series_among(fresh)) {
    if ((!series.problem.empty() || series.may_go_on) && still < 4 * quiet_) continue;
    for (const fs::path& file : series.files) {
      past_[file] = seen_[file];
      const auto changed = std::chrono::time_point_cast<std::chrono::system_clock::duration>(
          std::chrono::file_clock::to_sys(seen_[file].second));
      series.written = std::max(series.written, changed);
    }
    return std::move(series);
  }
  return std::nullopt;
}

namespace {

DicomSeries series_again(const IncomingSeries& series) {
  DicomFolder folder = scan_dicom_files(series.files);
  if (!folder.broken.empty()) throw *folder.broken.front().refusal;
  if (folder.series.size() != 1)
    throw ConfigError("changed while it was read", series.files.front().string(), "export the series again");
  return std::move(folder.series.front());
}

}  // namespace

Volume read_incoming(const IncomingSeries& series) {
  if (series.files.size() == 1) return read_volume(series.files.front());
  return read_dicom_series(series_again(series));
}

std::vector<Volume> read_incoming_stacks(const IncomingSeries& series) {
  if (series.files.size() == 1) return read_stacks(series.files.front());
  return read_dicom_slabs(series_again(series));
}

}  // namespace biopsy::imaging
