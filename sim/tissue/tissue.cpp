#include "sim/tissue/tissue.hpp"

#include <fmt/format.h>

#include "robot/common/config_error.hpp"
#include "robot/common/files/toml_reader.hpp"

namespace biopsy::sim {
namespace {

template <class Effect>
void take(TomlTable& table, Effect& effect) {
  for (const auto& parameter : Effect::parameters()) {
    if (parameter.name == "depth_mm" || parameter.name == "from_mm") continue;
    if (parameter.optional && !table.has(parameter.name)) continue;
    effect.*(parameter.member) =
        table.number(parameter.name, parameter.low, parameter.high) * parameter.si_per_unit;
  }
}

}  // namespace

TissueTable read_tissues(const std::filesystem::path& file) {
  TissueTable tissues = read_toml(file, [](TomlTable& root) {
    TissueTable read;
    TomlTable all = root.table("tissue");
    for (const std::string& name : all.names()) {
      TomlTable table = all.table(name);
      TissueLayer& layer = read[name];
      take(table, layer.surface);
      take(table, layer.shaft);
      take(table, layer.relaxation);
      table.ignore("source");
    }
    return read;
  });
  if (!tissues.contains("unknown"))
    throw ConfigError("no [tissue.unknown]", file.string(), "add the tissue that stands for unknown names");
  return tissues;
}

std::vector<TissueLayer> tissue_along(std::span<const Layer> layers, const TissueTable& table) {
  if (layers.size() > kMaxLayers)
    throw ConfigError(fmt::format("{} layers along the path; the plant holds {}", layers.size(), kMaxLayers),
                      "tissue", "merge thin layers in the label map or the table");
  std::vector<TissueLayer> tissue;
  for (const Layer& layer : layers) {
    const auto known = table.find(layer.name);
    TissueLayer made = known != table.end() ? known->second : table.at("unknown");
    made.surface.depth = made.shaft.from = made.relaxation.from = layer.from.value * 1e-3;
    if (&layer != &layers.back()) made.shaft.to = layer.to.value * 1e-3;
    tissue.push_back(made);
  }
  return tissue;
}

}  // namespace biopsy::sim
