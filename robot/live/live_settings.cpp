#include "robot/live/live_settings.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "drivers/needle_stage_factory.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/sha256.hpp"

namespace biopsy::live {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr double kStrokeMax_mm = 1000.0;  // no layer of a patient is deeper

constexpr const char* kRemedy = "start the robot with `biopsy up`, which writes it";

// Reads entries of one object and refuses those that were not requested.
class Entries {
 public:
  Entries(const Json& object, std::string where) : object_(object), where_(std::move(where)) {
    if (!object.is_object()) fail("", "is not an object");
  }

  template <class Integer>
  Integer integer(const char* name, std::int64_t low, std::int64_t high) {
    const Json& value = entry(name);
    if (!value.is_number_integer() ||
        (value.is_number_unsigned() && value.get<std::uint64_t>() > INT64_MAX) ||
        value.get<std::int64_t>() < low || value.get<std::int64_t>() > high)
      fail(name, fmt::format("is not a whole number from {} to {}", low, high));
    return static_cast<Integer>(value.get<std::int64_t>());
  }
  double number(const char* name, double low, double high) {
    const Json& value = entry(name);
    if (!value.is_number() || !(value.get<double>() >= low && value.get<double>() <= high))
      fail(name, fmt::format("is not a number from {} to {}", low, high));
    return value.get<double>();
  }
  std::string text(const char* name) {
    const Json& value = entry(name);
    if (!value.is_string()) fail(name, "is not a text");
    return value.get<std::string>();
  }
  const Json& list(const char* name) {
    const Json& value = entry(name);
    if (!value.is_array()) fail(name, "is not a list");
    return value;
  }
  bool has(const char* name) const { return object_.contains(name); }
  void refuse_rest() const {
    for (const auto& [name, value] : object_.items())
      if (!known_.contains(name)) fail(name, "is not known");
  }

 private:
  const Json& entry(const char* name) {
    known_.insert(name);
    const auto found = object_.find(name);
    if (found == object_.end()) fail(name, "is missing");
    return *found;
  }
  [[noreturn]] void fail(const std::string& name, const std::string& what) const {
    throw ConfigError(fmt::format("\"{}\" {}", name, what), where_,
                      "start the robot with `biopsy up`, which writes it");
  }

  const Json& object_;
  std::string where_;
  std::set<std::string> known_;
};

Layer layer_from(const Json& object, const std::string& where) {
  Entries from(object, where);
  Layer layer;
  layer.name = from.text("name");
  layer.from = Millimetres(from.number("from_mm", 0.0, kStrokeMax_mm));
  layer.to = Millimetres(from.number("to_mm", 0.0, kStrokeMax_mm));
  from.refuse_rest();
  return layer;
}

}  // namespace

fs::path own_folder(const fs::path& run_folder) {
  const char* given = std::getenv("STATE_DIRECTORY");
  return given == nullptr || *given == '\0' ? run_folder : fs::path(given);
}

fs::path settings_file(const fs::path& run_folder) {
  return run_folder / "live.json";
}

std::string to_json(const LiveSettings& settings) {
  Json layers = Json::array();
  for (const Layer& layer : settings.layers)
    layers.push_back({{"name", layer.name}, {"from_mm", layer.from.value}, {"to_mm", layer.to.value}});
  const Json object{{"domain", settings.domain},
                    {"robot", settings.robot},
                    {"keys", settings.keys.string()},
                    {"network", settings.network},
                    {"device", settings.device},
                    {"device_config", settings.device_config.string()},
                    {"commissioning", settings.commissioning.string()},
                    {"commissioning_key", settings.commissioning_key.string()},
                    {"log", settings.log.string()},
                    {"log_key", settings.log_key.string()},
                    {"lines", settings.lines.string()},
                    {"fifo_priority", settings.fifo_priority},
                    {"model", settings.model.string()},
                    {"tissues", settings.tissues.string()},
                    {"faults", settings.faults.string()},
                    {"weight_g", settings.weight_g},
                    {"seed", settings.seed},
                    {"layers", layers}};
  return object.dump(2) + "\n";
}

LiveSettings parse_settings(const std::string& text, const std::string& name) {
  const Json object = Json::parse(text, nullptr, false);
  if (object.is_discarded())
    throw ConfigError("the file is not JSON", name, "start the robot with `biopsy up`, which writes it");
  Entries from(object, name);
  LiveSettings settings;
  settings.domain = from.integer<std::uint32_t>("domain", 0, 230);
  settings.robot = from.integer<std::uint32_t>("robot", 1, UINT32_MAX);
  settings.keys = from.text("keys");
  settings.network = from.text("network");
  settings.device = from.text("device");
  drivers::check_stage_device(settings.device, name);
  settings.device_config = from.text("device_config");
  settings.commissioning = from.text("commissioning");
  settings.commissioning_key = from.text("commissioning_key");
  settings.log = from.text("log");
  settings.log_key = from.text("log_key");
  settings.lines = from.text("lines");
  settings.fifo_priority = from.integer<int>("fifo_priority", 0, 90);
  settings.model = from.text("model");
  settings.tissues = from.text("tissues");
  if (from.has("faults")) settings.faults = from.text("faults");
  settings.weight_g = from.number("weight_g", 0.0, 1000.0);
  settings.seed = from.integer<std::uint64_t>("seed", 0, INT64_MAX);
  for (const Json& layer : from.list("layers")) settings.layers.push_back(layer_from(layer, name));
  from.refuse_rest();
  return settings;
}

LiveSettings read_settings(const fs::path& run_folder) {
  return parse_settings(read_file(settings_file(run_folder), kRemedy), settings_file(run_folder).string());
}

std::uint64_t config_tag(const fs::path& run_folder, const LiveSettings& settings) {
  std::string bytes = read_file(settings_file(run_folder), kRemedy);
  for (const fs::path& file : {settings.model, settings.tissues, settings.faults, settings.device_config})
    if (!file.empty()) bytes += read_file(file, kRemedy);
  const std::uint64_t tag = first_64_bits(sha256(bytes));
  return tag == 0 ? 1 : tag;
}

}  // namespace biopsy::live
