#include "robot/console/console_series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "planner/imaging/io/read_volume.hpp"
#include "robot/common/config_error.hpp"
#include "robot/console/console_events.hpp"
#include "robot/console/server/nifti_bytes.hpp"

namespace biopsy::robot {

namespace events = console::events;

namespace {

constexpr std::size_t kListMax = 64, kTextMax = 300;

events::Series listed(const imaging::SeriesSummary& found) {
  events::Series series;
  series.series_uid = found.series_uid;
  series.description = found.description.empty() ? found.series_uid : found.description;
  series.modality = found.modality;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    series.size[axis] = static_cast<std::uint32_t>(found.size[static_cast<int>(axis)]);
    series.spacing[axis] = found.spacing_mm[static_cast<int>(axis)];
  }
  series.problem = found.problem.substr(0, kTextMax);
  return series;
}

std::shared_ptr<const std::string> file_of(const Volume& image) {
  return std::make_shared<const std::string>(console::nifti_bytes(image));
}

bool differ(const std::string& one, const std::string& other) {
  return !one.empty() && !other.empty() && one != other;
}

// Points, layers and fiducials of a case belong to its patient and its frame of reference.
bool is_bound(const Case& given) {
  return has_points(given) || !given.labels.empty() || !given.fiducials.empty() || given.transform ||
         !given.layers.empty();
}

}  // namespace

ConsoleSeries::ConsoleSeries(const PreparedCase& opened)
    : folder_(opened.given.image),
      of_case_(is_bound(opened.given) ? opened.image.identity : SeriesIdentity()),
      file_(file_of(opened.image)),
      labels_(opened.labels ? file_of(*opened.labels) : nullptr) {
  all_.push_back(series_of(opened.image));
  if (opened.given.phantom) return;
  for (const imaging::SeriesSummary& found : imaging::list_series(folder_)) {
    const bool own = std::find_first_of(found.files.begin(), found.files.end(), opened.image.files.begin(),
                                        opened.image.files.end()) != found.files.end();
    if (own)
      all_.front().series_uid = found.series_uid;  // a file without a UID is identified by its name
    else if (all_.size() < kListMax)
      all_.push_back(listed(found));
  }
}

std::string ConsoleSeries::file_name() const {
  return fmt::format("/volume-{}.nii", files_);
}

events::Series* ConsoleSeries::find(const std::string& series_uid) {
  const auto found = std::find_if(all_.begin(), all_.end(), [&](const events::Series& series) {
    return series.series_uid == series_uid;
  });
  return found == all_.end() ? nullptr : &*found;
}

std::optional<std::string> ConsoleSeries::begin(const std::string& series_uid) {
  const events::Series* series = find(series_uid);
  if (series == nullptr) return "there is no such series in this case";
  if (!series->problem.empty()) return series->problem;
  if (!reading_.empty()) return "another series is being read";
  reading_ = series_uid;
  outcome_ = std::async(std::launch::async, read, folder_, series_uid, of_case_);
  return std::nullopt;
}

ConsoleSeries::Outcome ConsoleSeries::read(const std::filesystem::path& folder, const std::string& series_uid,
                                           const SeriesIdentity& of_case) {
  try {
    Read done{imaging::read_volume(folder, series_uid), nullptr};
    SeriesIdentity& identity = done.image.identity;
    if (differ(identity.patient_id, of_case.patient_id)) return "it is of another patient than the case";
    if (differ(identity.frame_of_reference_uid, of_case.frame_of_reference_uid))
      return "it is in another frame of reference than the image of the case";
    if (identity.series_uid.empty()) identity.series_uid = series_uid;
    done.file = file_of(done.image);
    return done;
  } catch (const ConfigError& error) {
    return error.what_is_wrong.substr(0, kTextMax);
  }
}

std::optional<Volume> ConsoleSeries::take() {
  using std::chrono::seconds;
  if (!outcome_.valid() || outcome_.wait_for(seconds(0)) != std::future_status::ready) return std::nullopt;
  Outcome outcome = outcome_.get();
  events::Series& series = *find(std::exchange(reading_, {}));
  ++version_;
  if (const auto* problem = std::get_if<std::string>(&outcome)) {
    series.problem = *problem;
    return std::nullopt;
  }
  auto& done = std::get<Read>(outcome);
  series = series_of(done.image);
  file_ = std::move(done.file);
  ++files_;
  return std::move(done.image);
}

}  // namespace biopsy::robot
