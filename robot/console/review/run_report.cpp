#include "robot/console/review/run_report.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "robot/common/config_error.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/common/text/text_layout.hpp"
#include "robot/report/procedure/labels.hpp"

namespace biopsy::console {
namespace {

using Json = nlohmann::json;

constexpr double kTime_s = 1e6, kDepth_mm = 1e4;
constexpr std::size_t kSentence = 290, kTitle = 120, kListMax = 1000;

// One object of the report, read entry by entry.
class Entries {
 public:
  Entries(const Json& object, std::string place) : object_(object), place_(std::move(place)) {
    if (!object.is_object()) refuse("is not an object");
  }

  std::string text(const char* name, std::size_t most) const {
    const Json& value = entry(name);
    if (!value.is_string()) refuse(fmt::format("`{}` is not a text", name));
    return shortened(plain(value.get<std::string>()), most);
  }
  bool flag(const char* name) const {
    const Json& value = entry(name);
    if (!value.is_boolean()) refuse(fmt::format("`{}` is neither true nor false", name));
    return value.get<bool>();
  }
  double number(const char* name, double low, double high) const {
    const Json& value = entry(name);
    if (!value.is_number() || !(value.get<double>() >= low && value.get<double>() <= high))
      refuse(fmt::format("`{}` is not a number from {} to {}", name, low, high));
    return value.get<double>();
  }
  std::uint64_t whole(const char* name) const {
    const Json& value = entry(name);
    if (!value.is_number_unsigned()) refuse(fmt::format("`{}` is not a whole number", name));
    return value.get<std::uint64_t>();
  }
  template <class Enumeration>
  Enumeration label(const char* name) const {
    const auto value = report::labelled<Enumeration>(text(name, kSentence));
    if (!value) refuse(fmt::format("`{}` is none of the names it may have", name));
    return *value;
  }
  bool known(const char* name) const { return !entry(name).is_null(); }
  Entries object(const char* name) const { return {entry(name), fmt::format("{}: {}", place_, name)}; }
  template <class Read>
  void each(const char* name, Read read) const {
    const Json& list = entry(name);
    if (!list.is_array() || list.size() > kListMax)
      refuse(fmt::format("`{}` is not a list of at most {}", name, kListMax));
    for (std::size_t i = 0; i < list.size(); ++i)
      read(Entries(list[i], fmt::format("{}: {} {}", place_, name, i + 1)));
  }
  [[noreturn]] void refuse(const std::string& what) const {
    throw ConfigError(what, place_, "give the folder of a run as `biopsy dry-run` or the console wrote it");
  }

 private:
  const Json& entry(const char* name) const {
    const auto found = object_.find(name);
    if (found == object_.end()) refuse(fmt::format("`{}` is missing", name));
    return *found;
  }

  const Json& object_;
  std::string place_;
};

review::Hazard hazard_from(const Entries& trip) {
  return {trip.number("time_s", 0.0, kTime_s), trip.label<StopCategory>("stop"),
          trip.text("reason", kSentence)};
}

review::ConfirmationImage image_from(const Entries& step) {
  review::ConfirmationImage image;
  const std::uint64_t number = step.whole("number");
  if (number < 1 || number > kListMax) step.refuse("`number` is no step");
  image.step = static_cast<std::uint32_t>(number);
  image.at = step.number("image_s", 0.0, kTime_s);
  image.planned = step.number("depth_mm", -kDepth_mm, kDepth_mm);
  if (!step.known("check")) return image;
  const Entries check = step.object("check");
  image.verdict = report::label(check.label<DepthVerdict>("verdict"));
  image.reason = check.text("reason", kSentence);
  image.tip_found = check.flag("tip_found");
  if (image.tip_found) {
    image.found = check.number("depth_mm", -kDepth_mm, kDepth_mm);
    image.sigma = check.number("sigma_mm", 0.0, kDepth_mm);
  }
  return image;
}

}  // namespace

RunReport parse_run_report(const std::string& text, const std::string& file_name) {
  const Json object = Json::parse(text, nullptr, false);
  const Entries from(object, file_name);
  RunReport report;
  const auto outcome = from.label<report::Outcome>("outcome");
  if (outcome == report::Outcome::Refused) {
    const std::string why = from.known("refusal") ? from.text("refusal", kSentence) : "it was only planned";
    throw ConfigError("nothing moved in this run: " + why, file_name,
                      "give the folder of a run that was begun");
  }
  report.outcome = report::label(outcome);
  report.title = from.text("title", kTitle);
  report.verdict = from.text("verdict", kSentence);
  report.simulated = from.flag("simulated");
  report.seed = std::to_string(from.whole("seed"));
  from.each("trips", [&](const Entries& trip) { report.hazards.push_back(hazard_from(trip)); });
  from.each("stages", [&](const Entries& step) {
    if (step.known("image_s")) report.images.push_back(image_from(step));
  });
  return report;
}

}  // namespace biopsy::console
