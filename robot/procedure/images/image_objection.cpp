#include "robot/procedure/images/image_objection.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

namespace biopsy::robot {
namespace {

using Time = std::chrono::system_clock::time_point;

std::string clock_text(Time time) {
  return fmt::format("{:%H:%M:%S}", fmt::localtime(std::chrono::system_clock::to_time_t(time)));
}

// Without letter case and the empty components that some writers leave at the end of a name.
std::string plain(std::string name) {
  while (!name.empty() && (name.back() == '^' || name.back() == ' ')) name.pop_back();
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return name;
}

bool differ(const std::string& a, const std::string& b) {
  return !a.empty() && !b.empty() && plain(a) != plain(b);
}

std::string objection_to_content(const imaging::IncomingSeries& image) {
  const std::string type = plain(image.image_type), description = plain(image.identity.description);
  if (plain(image.identity.patient_name).starts_with("SIMULATED"))
    return "the image was simulated: it does not show this patient";
  if (type.find("LOCALIZER") != std::string::npos) return "the image is a localiser";
  if (type.starts_with("DERIVED"))
    return "the image was derived from others, and not measured: export the original series";
  if (differ(image.identity.modality, "MR"))
    return fmt::format("the image is of modality {:.16}, not MR", image.identity.modality);
  constexpr std::array<const char*, 6> kOthers{"LOCALI",      "SCOUT", "SURVEY",
                                               "CALIBRATION", "PHASE", "SUBTRACT"};
  for (const char* word : kOthers)
    if (description.find(word) != std::string::npos)
      return fmt::format("the series is described as \"{:.64}\", which is no confirmation image",
                         image.identity.description);
  return {};
}

std::string objection_to_identity(const imaging::IncomingSeries& image, const ExpectedImage& expected) {
  const SeriesIdentity &here = image.identity, &planned = expected.planning;
  if (differ(here.patient_id, planned.patient_id) || differ(here.patient_name, planned.patient_name))
    return fmt::format("the image is of another patient: {:.64} {:.64}", here.patient_name, here.patient_id);
  if (differ(here.frame_of_reference_uid, planned.frame_of_reference_uid))
    return "the image lies in another frame of reference than the planning image: the patient may have been "
           "moved out and in";
  if (!here.series_uid.empty() && here.series_uid == planned.series_uid)
    return "the image is the planning series itself";
  const bool named = !here.patient_id.empty() && !here.frame_of_reference_uid.empty();
  if (!named && expected.confirmed_by.empty())
    return "the image does not name its patient and frame of reference, and nobody answers for it";
  if ((planned.patient_id.empty() || planned.frame_of_reference_uid.empty()) && expected.confirmed_by.empty())
    return "the planning image does not name its patient and frame of reference, and nobody answers that "
           "this "
           "image is of the same";
  return {};
}

// Scanners that state no fractions name the second in which the acquisition began, not the moment.
std::string objection_to_early(Time acquired, Time arrived) {
  if (acquired >= arrived) return {};
  const bool whole = acquired.time_since_epoch() % std::chrono::seconds(1) == Time::duration::zero();
  if (whole && arrived - acquired < std::chrono::seconds(1))
    return fmt::format(
        "the image says only that it was acquired in the second of {}, in which the needle arrived as well: "
        "take "
        "another one",
        clock_text(acquired));
  return fmt::format(
      "the image was acquired at {}, {:.1f} s before the needle arrived at {}: take another one; if it was "
      "begun "
      "later, the scanner's clock is behind this machine's",
      clock_text(acquired), std::chrono::duration<double>(arrived - acquired).count(), clock_text(arrived));
}

std::string objection_to_time(const imaging::IncomingSeries& image, const ExpectedImage& expected) {
  if (image.written < expected.arrived)
    return fmt::format("the image was written at {}, before the needle arrived at {}",
                       clock_text(image.written), clock_text(expected.arrived));
  if (!image.acquired)
    return expected.confirmed_by.empty()
               ? "the image does not say when it was acquired, and nobody answers for it"
               : "";
  if (expected.last_acquired && *image.acquired <= *expected.last_acquired)
    return fmt::format("the image was acquired at {}, not after the confirmation before it at {}",
                       clock_text(*image.acquired), clock_text(*expected.last_acquired));
  if (const std::string early = objection_to_early(*image.acquired, expected.arrived); !early.empty())
    return early;
  if (*image.acquired > expected.now + kClockTolerance)
    return fmt::format(
        "the image says that it was acquired at {}, and it is {}: the scanner's clock is wrong",
        clock_text(*image.acquired), clock_text(expected.now));
  return {};
}

}  // namespace

std::string image_objection(const imaging::IncomingSeries& image, const ExpectedImage& expected) {
  if (!image.problem.empty()) return "the image cannot be read: " + image.problem;
  for (const std::string& objection : {objection_to_content(image), objection_to_identity(image, expected),
                                       objection_to_time(image, expected)})
    if (!objection.empty()) return objection;
  return {};
}

}  // namespace biopsy::robot
