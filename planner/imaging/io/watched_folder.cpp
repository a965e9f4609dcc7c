#include "planner/imaging/io/watched_folder.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "planner/imaging/io/dicom/plane_series.hpp"
#include "planner/imaging/io/grid_rules.hpp"
#include "planner/imaging/io/read_volume.hpp"
#include "planner/imaging/io/volume_files.hpp"
#include "robot/common/config_error.hpp"

namespace biopsy::imaging {
namespace fs = std::filesystem;

namespace {

IncomingSeries incoming_of(const DicomSeries& series) {
  IncomingSeries incoming;
  for (const DicomFile& file : series.files) {
    incoming.files.push_back(file.file);
    incoming.slices += static_cast<int>(file.slices.size());
    incoming.stated = std::max(incoming.stated, file.images_in_acquisition);
    if (file.acquired && (!incoming.acquired || *file.acquired < *incoming.acquired))
      incoming.acquired = file.acquired;
  }
  incoming.identity = series.files.front().identity;
  incoming.image_type = series.files.front().image_type;
  try {
    const std::vector<SliceStack> stacks = slabs_of(series);
    incoming.may_go_on = incoming.stated == 0 && (stacks.size() > 1 || incoming.slices < kSizeMin);
    if (incoming.stated > incoming.slices)
      incoming.problem = fmt::format("{} of {} slices have arrived", incoming.slices, incoming.stated);
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

// Why planes that arrived together are no image; empty: they are one.
std::string problem_of(std::span<const DicomSeries> planes, std::size_t wanted) {
  for (const DicomSeries& plane : planes)
    if (const std::string apart =
            taken_apart(planes.front().files.front().identity, plane.files.front().identity);
        !apart.empty())
      return apart + " in the planes of one image";
  if (planes.size() > wanted)
    return fmt::format("{} planes have arrived, and an image has {} at most", planes.size(), wanted);
  for (std::size_t n = 1; n < planes.size(); ++n)
    for (std::size_t m = 0; m < n; ++m)
      if (!in_other_planes(planes[n], planes[m]))
        return "two planes of one orientation have arrived: which of them belongs to the image is not "
               "certain";
  return {};
}

// `wanted`: how many planes an image has; 0: not known.
IncomingImage image_of(std::span<const DicomSeries> planes, std::size_t wanted) {
  IncomingImage image;
  int slices = 0, stated = 0;
  for (const DicomSeries& plane : planes) {
    image.push_back(incoming_of(plane));
    image.back().plane = true;
    slices += image.back().slices;
    stated = std::max(stated, image.back().stated);
  }
  const bool of_all = planes.size() > 1 && stated == slices;  // a number that counts the slices of all planes
  const std::string problem = problem_of(planes, wanted == 0 ? kPlanesMax : wanted);
  for (IncomingSeries& one : image) {
    if (of_all) one.problem.clear(), one.may_go_on = false;
    if (wanted == 0 && planes.size() < kPlanesMax && !of_all) one.may_go_on = true;
    if (!problem.empty()) one.problem = problem;
  }
  return image;
}

}  // namespace

// All images of which at least one file is new.
std::vector<IncomingImage> WatchedFolder::fresh() const {
  VolumeFiles files;
  for (const auto& [file, stamp] : seen_) {
    const auto known = past_.find(file);
    if (known == past_.end() || known->second != stamp) add_volume_file(file, files);
  }
  std::vector<IncomingImage> all;
  DicomFolder folder = scan_dicom_files(files.dicom);
  const auto others = planes_ == 1
                          ? folder.series.begin()
                          : std::stable_partition(folder.series.begin(), folder.series.end(), is_plane);
  const std::span<const DicomSeries> planes(folder.series.begin(), others);
  if (!planes.empty()) all.push_back(image_of(planes, planes_));
  for (auto series = others; series != folder.series.end(); ++series) all.push_back({incoming_of(*series)});
  for (const DicomFile& file : folder.broken) {
    IncomingSeries broken;
    broken.files = {file.file};
    broken.problem = file.refusal->what();
    all.push_back({broken});
  }
  for (const auto* formats : {&files.nifti, &files.nrrd, &files.metaimage})
    for (const fs::path& file : *formats) all.push_back({incoming_of(file)});
  return all;
}

WatchedFolder::WatchedFolder(fs::path folder, std::chrono::milliseconds quiet, std::size_t planes)
    : folder_(std::move(folder)), quiet_(quiet), planes_(planes) {
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

IncomingImage WatchedFolder::poll(std::chrono::steady_clock::time_point now) {
  Listing files = list();
  if (files != seen_ || !changed_) {
    seen_ = std::move(files);
    changed_ = now;
    return {};
  }
  const auto still = now - *changed_;
  if (still < quiet_) return {};
  for (IncomingImage& image : fresh()) {
    const bool whole = std::ranges::all_of(
        image, [](const IncomingSeries& series) { return series.problem.empty() && !series.may_go_on; });
    if (lacks_planes(image) || (!whole && still < 4 * quiet_)) continue;
    for (IncomingSeries& series : image) take(series);
    return std::move(image);
  }
  return {};
}

// Planes that were not taken together get no better by waiting for more.
bool WatchedFolder::lacks_planes(const IncomingImage& image) const {
  return image.front().plane && image.size() < planes_ && image.front().problem.empty();
}

void WatchedFolder::take(IncomingSeries& series) {
  for (const fs::path& file : series.files) {
    past_[file] = seen_[file];
    const auto changed = std::chrono::time_point_cast<std::chrono::system_clock::duration>(
        std::chrono::file_clock::to_sys(seen_[file].second));
    series.written = std::max(series.written, changed);
  }
}

std::string WatchedFolder::incomplete() const {
  std::string text;
  for (const IncomingImage& image : fresh()) {
    int slices = 0;
    for (const IncomingSeries& series : image) slices += series.slices;
    const IncomingSeries& first = image.front();
    text += text.empty() ? "" : "; ";
    text += lacks_planes(image)      ? fmt::format("{} of {} planes", image.size(), planes_)
            : !first.problem.empty() ? first.problem
            : slices == 1            ? "1 slice that was not quiet for long enough"
                                     : fmt::format("{} slices that were not quiet for long enough", slices);
  }
  return text;
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

std::vector<Volume> read_incoming_stacks(const IncomingImage& image) {
  std::vector<Volume> all;
  for (const IncomingSeries& series : image)
    for (Volume& stack : series.files.size() == 1 ? read_stacks(series.files.front())
                                                  : read_dicom_slabs(series_again(series)))
      all.push_back(std::move(stack));
  return all;
}

}  // namespace biopsy::imaging
