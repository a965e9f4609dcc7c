#include "robot/cli/commands/depth_images.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "planner/imaging/io/dicom/plane_series.hpp"
#include "planner/imaging/io/read_volume.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/config_error.hpp"

namespace biopsy::robot {
namespace {

constexpr std::string_view kSimulated = "SIMULATED-";

bool simulated(const Volume& image) {
  return image.identity.patient_id.starts_with(kSimulated);
}

// An image that the simulated scanner made of patient X is of "SIMULATED-X": it may be compared with those of
// X.
std::string patient_of(const Volume& image) {
  const std::string& id = image.identity.patient_id;
  return simulated(image) ? id.substr(kSimulated.size()) : id;
}

void refuse_two_patients(const Volume& before, const Volume& after) {
  const std::string a = patient_of(before), b = patient_of(after);
  if (!a.empty() && !b.empty() && a != b)
    throw ConfigError(fmt::format("the images show two patients, \"{}\" and \"{}\"", a, b),
                      "--before, --after", "give two images of one patient");
}

// The simulated scanner has a frame of its own.
bool other_frame(const Volume& before, const Volume& after) {
  const std::string &a = before.identity.frame_of_reference_uid, &b = after.identity.frame_of_reference_uid;
  return !a.empty() && !b.empty() && a != b && !simulated(before) && !simulated(after);
}

bool acquired_earlier(const Volume& one, const Volume& other) {
  const auto a = imaging::acquired(one), b = imaging::acquired(other);
  return a && b && *a < *b;
}

}  // namespace

std::vector<std::filesystem::path> DepthImageOptions::files() const {
  std::vector<std::filesystem::path> all = after;
  all.push_back(before);
  return all;
}

void add_depth_images(CLI::App& app, DepthImageOptions& options) {
  add(app, "--before PATH", options.before, "image without the needle")->required();
  add(app, "--after PATH...", options.after,
      "image with the needle: a volume, a slab of 1 to 3 slices, or up to three such planes; a folder of "
      "three planes as a series each is one image")
      ->required()
      ->expected(1, 3);
  add(app, "--before-series UID", options.before_series, "series UID, where that folder holds several");
  add(app, "--after-series UID...", options.after_series,
      "series UID, where that folder holds several; several for planes")
      ->expected(1, 3);
}

DepthImages read_depth_images(const DepthImageOptions& options) {
  if (options.after.size() > 1 && !options.after_series.empty())
    throw ConfigError("series for several images", "--after-series",
                      "give one folder and its series, or folders of one series each");
  DepthImages images;
  images.before = imaging::read_volume(options.before, options.before_series);
  const auto take = [&](const std::filesystem::path& path, const std::string& series) {
    for (Volume& stack : imaging::read_stacks(path, series)) images.after.push_back(std::move(stack));
  };
  for (const std::string& series : options.after_series) take(options.after.front(), series);
  if (options.after_series.empty())
    for (const std::filesystem::path& path : options.after) take(path, "");
  imaging::refuse_taken_apart(images.after, "--after");
  const auto warn = [&](const std::string& warning) {
    const auto& said = images.warnings;
    if (std::find(said.begin(), said.end(), warning) == said.end()) images.warnings.push_back(warning);
  };
  for (const std::string& warning : images.before.warnings) warn("image before: " + warning);
  for (const Volume& stack : images.after) {
    refuse_two_patients(images.before, stack);
    for (const std::string& warning : stack.warnings) warn("image after: " + warning);
    if (other_frame(images.before, stack))
      warn(
          "the images lie in two frames of reference: the patient may have been moved out and in between "
          "them");
    if (acquired_earlier(stack, images.before))
      warn("the image after was acquired earlier than the image before: were they swapped?");
  }
  return images;
}

std::string warning_lines(const std::vector<std::string>& warnings) {
  std::string text;
  for (const std::string& warning : warnings) text += "warning   " + warning + "\n";
  return text;
}

}  // namespace biopsy::robot
