#include "drivers/commissioning/record.hpp"

#include <fmt/chrono.h>

#include <algorithm>
#include <ctime>
#include <limits>
#include <nlohmann/json.hpp>

#include "drivers/commissioning/steps.hpp"
#include "robot/common/config_error.hpp"

namespace biopsy::commissioning {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;
constexpr std::int64_t kTooFar_s =
    4'102'444'800;  // the year 2100: later dates are mistakes, and a clock in ns overflows in 2262

Json json_of(const Figure& figure) {
  return {{"what", figure.what}, {"unit", figure.unit}, {"value", figure.value}, {"low", figure.low},
          {"high", figure.high}, {"why", figure.why},   {"ok", figure.ok()}};
}

Json json_of(const StepRecord& step) {
  Json figures = Json::array();
  for (const Figure& figure : step.figures) figures.push_back(json_of(figure));
  return {{"name", step.name}, {"passed", step.passed()}, {"note", step.note}, {"figures", figures}};
}

// NaN is written as null: JSON has no NaN.
double number_or_none(const Json& value) {
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

Figure figure_of(const Json& json) {
  return {json.at("what").get<std::string>(), json.at("unit").get<std::string>(),
          number_or_none(json.at("value")),   json.at("low").get<double>(),
          json.at("high").get<double>(),      json.at("why").get<std::string>()};
}

StepRecord step_of(const Json& json) {
  StepRecord step{json.at("name").get<std::string>(), {}, json.at("note").get<std::string>()};
  for (const Json& figure : json.at("figures")) step.figures.push_back(figure_of(figure));
  return step;
}

Record record_of(const Json& json) {
  Record record;
  const Json& device = json.at("device");
  record.device = {device.at("kind").get<std::string>(), device.at("product").get<std::string>(),
                   device.at("serial").get<std::uint32_t>()};
  record.config_sha256 = json.at("config_sha256").get<std::string>();
  record.software = json.at("software").get<std::string>();
  record.made_unix_s = json.at("made_unix_s").get<std::int64_t>();
  for (const Json& step : json.at("steps")) record.steps.push_back(step_of(step));
  return record;
}

}  // namespace

bool StepRecord::passed() const {
  return !figures.empty() &&
         std::all_of(figures.begin(), figures.end(), [](const Figure& f) { return f.ok(); });
}

bool Record::passed() const {
  const auto same = [](const Step& step, const StepRecord& done) {
    return done.name == step.name && done.figures.size() == step.limits.size() && done.passed();
  };
  return std::equal(all_steps().begin(), all_steps().end(), steps.begin(), steps.end(), same);
}

std::string to_json(const Record& record) {
  Json steps = Json::array();
  for (const StepRecord& step : record.steps) steps.push_back(json_of(step));
  const auto made = static_cast<std::time_t>(record.made_unix_s);
  const Json json{
      {"format", kFormat},
      {"verdict", record.passed() ? "passed" : "failed"},
      {"device",
       {{"kind", record.device.kind}, {"product", record.device.product}, {"serial", record.device.serial}}},
      {"config_sha256", record.config_sha256},
      {"software", record.software},
      {"date", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(made))},
      {"made_unix_s", record.made_unix_s},
      {"steps", steps}};
  return json.dump(2) + "\n";
}

Record from_json(std::string_view text, const std::string& place) {
  try {
    const Json json = Json::parse(text);
    Record record = record_of(json);
    const bool dated = record.made_unix_s >= 0 && record.made_unix_s < kTooFar_s;
    if (dated && json.at("format").get<int>() == kFormat) return record;
  } catch (const Json::exception&) {  // refused below
  }
  throw ConfigError("is no commissioning record that this version reads", place,
                    "commission the stage anew: biopsy commission");
}

}  // namespace biopsy::commissioning
