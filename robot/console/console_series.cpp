#include "robot/console/console_series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "planner/imaging/io/read_volume.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/logging/logger.hpp"
#include "robot/console/console_events.hpp"
#include "robot/console/server/nifti_bytes.hpp"
#include "robot/live/realtime/become_realtime.hpp"

namespace biopsy::robot {

namespace events = console::events;

namespace {

constexpr std::size_t kListMax = 64, kTextMax = 300;
constexpr std::int64_t kFolderEvery_us = 2'000'000;  // ten thousand files take up to 0.1 s
constexpr logging::Logger kLog{logging::Component::Console};

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

// Points, layers and fiducials of a case belong to its patient and its frame of reference.
bool is_bound(const Case& given) {
  return has_points(given) || !given.labels.empty() || !given.fiducials.empty() || given.transform ||
         !given.layers.empty();
}

}  // namespace

ConsoleSeries::ConsoleSeries(const PreparedCase& opened)
    : folder_(opened.given.image),
      of_case_(is_bound(opened.given) ? opened.image.identity : SeriesIdentity()),
      patient_id_(opened.image.identity.patient_id),
      confirmed_by_(opened.given.images.confirmed_by),
      file_(file_of(opened.image)),
      labels_(opened.labels ? file_of(*opened.labels) : nullptr) {
  const auto& images = opened.given.images;
  // To plan on, each series is looked at by itself.
  if (!images.folder.empty()) watched_.emplace(images.folder, images.quiet, 1);
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
  std::function<Volume()> load = [folder = folder_, series_uid] {
    return imaging::read_volume(folder, series_uid);
  };
  if (const auto came = received_.find(series_uid); came != received_.end())
    load = [files = came->second, patient_id = patient_id_] {
      Volume image = imaging::read_incoming(files);
      // A person answers that it is of this patient: later images are compared with that.
      if (image.identity.patient_id.empty()) image.identity.patient_id = patient_id;
      return image;
    };
  outcome_ = std::async(std::launch::async, read, load, series_uid, of_case_);
  return std::nullopt;
}

void ConsoleSeries::look(std::int64_t now_us) {
  if (!watched_) return;
  if (coming_.valid()) {
    if (coming_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
    if (std::optional<Received> received = coming_.get()) add(std::move(*received));
  }
  if (now_us - looked_us_ < kFolderEvery_us) return;
  looked_us_ = now_us;
  coming_ = std::async(std::launch::async, [this] { return poll(); });
}

std::optional<ConsoleSeries::Received> ConsoleSeries::poll() {
  realtime::run_in_background();
  try {
    imaging::IncomingImage came = watched_->poll(std::chrono::steady_clock::now());
    if (came.empty()) return std::nullopt;
    Received received{std::move(came.front()), {}};
    const imaging::IncomingSeries& files = received.files;
    events::Series& series = received.series;
    try {
      if (files.problem.empty()) series = series_of(imaging::read_incoming(files));
      series.problem = files.problem;
    } catch (const ConfigError& error) {
      series.problem = error.what_is_wrong;
    }
    const std::string file = files.files.front().filename().string();
    series.series_uid = files.identity.series_uid.empty() ? file : files.identity.series_uid;
    if (series.description.empty()) series.description = file;
    series.description += ", received";
    if (stated_otherwise(files.identity.patient_id, patient_id_))
      series.problem = "it is of another patient than the case";
    else if (files.identity.patient_id.empty() && confirmed_by_.empty())
      series.problem = "it does not name its patient: start with --images-confirmed-by NAME";
    series.problem.resize(std::min(series.problem.size(), kTextMax));
    return received;
  } catch (const ConfigError& error) {
    kLog.warning("{}", error.what());  // a folder that cannot be read now may be readable later
    return std::nullopt;
  }
}

void ConsoleSeries::add(Received received) {
  const std::string& uid = received.series.series_uid;
  events::Series* known = find(uid);
  if (known != nullptr && !received_.contains(uid)) return;  // the case has it
  if (known == nullptr && all_.size() >= kListMax)
    return kLog.warning("{} series are listed: {} is left out", all_.size(), uid);
  ++version_;
  received_[uid] = std::move(received.files);
  if (known != nullptr)
    *known = received.series;
  else
    all_.push_back(received.series);
}

ConsoleSeries::Outcome ConsoleSeries::read(const std::function<Volume()>& load, const std::string& series_uid,
                                           const SeriesIdentity& of_case) {
  realtime::run_in_background();
  try {
    Read done{load(), nullptr};
    SeriesIdentity& identity = done.image.identity;
    if (stated_otherwise(identity.patient_id, of_case.patient_id))
      return "it is of another patient than the case";
    if (stated_otherwise(identity.frame_of_reference_uid, of_case.frame_of_reference_uid))
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
  std::string listed_as = std::move(series.description);
  series = series_of(done.image);
  series.description = std::move(listed_as);
  file_ = std::move(done.file);
  ++files_;
  return std::move(done.image);
}

}  // namespace biopsy::robot
