#include "sim/paper/calibration/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robot/common/config_error.hpp"
#include "sim/plant/baseline_entries.hpp"

namespace biopsy::sim::calibration {
namespace {

using paper::Film;
using paper::PaperModel;

struct Place {
  double* si = nullptr;
  double si_per_unit = 1.0;
};

Place in_film(Film& film, std::string_view name) {
  if (name == "K") return {&film.K};
  if (name == "tau") return {&film.tau};
  return {};
}

Place outside_stage(PaperModel& model, const std::string& name) {
  if (name.starts_with("film.pi25.")) return in_film(model.pi25, name.substr(10));
  if (name.starts_with("film.bopp25.")) return in_film(model.bopp25, name.substr(12));
  if (name == "joint.mass_g") return {&model.joint.mass, 1e-3};
  if (name == "joint.friction_N") return {&model.joint.friction};
  if (name == "joint.breakaway") return {&model.joint.breakaway};
  if (name == "loop.period_ms") return {&model.loop_period, 1e-3};
  if (name == "impact.drop_mm") return {&model.drop, 1e-3};
  return {};
}

Place in_effects(Effects& effects, const std::string& name) {
  Place found;
  for_each_effect(effects, [&](auto& slot) {
    using Effect = typename std::decay_t<decltype(slot)>::value_type;
    for (const auto& parameter : Effect::parameters()) {
      if (name != fmt::format("{}.{}", Effect::info.name, parameter.name)) continue;
      if (!slot) {
        slot.emplace();
        for (const auto& other : Effect::parameters())
          (*slot).*(other.member) = other.role == Role::Strength ? 0.0 : other.typical * other.si_per_unit;
      }
      found = {&((*slot).*(parameter.member)), parameter.si_per_unit};
    }
  });
  return found;
}

Place place_of(PaperModel& model, const std::string& name) {
  if (const BaselineEntry* entry = baseline_entry(name)) return {&(model.stage.baseline.*(entry->member))};
  Place place = outside_stage(model, name);
  if (place.si == nullptr) place = in_effects(model.stage.effects, name);
  if (place.si == nullptr)
    throw ConfigError(fmt::format("nothing in a model is called `{}`", name), "calibration",
                      "name a value of [baseline], EFFECT.PARAMETER, film.NAME.tau or joint.mass_g");
  return place;
}

// C2/C1 goes with eps/d at one size.
void follow_stage(const Baseline& stage, Film& film) {
  const double ratio = (film.eps_film / film.d_film) / (stage.eps_film / stage.d_film);
  film.K = 1.0 / (1.0 + (1.0 / stage.K - 1.0) * ratio);
}

}  // namespace

double value_of(const PaperModel& model, const std::string& name) {
  PaperModel copy = model;
  const Place place = place_of(copy, name);
  return *place.si / place.si_per_unit;
}

void set_value(PaperModel& model, const std::string& name, double value) {
  const Place place = place_of(model, name);
  *place.si = value * place.si_per_unit;
}

double to_search(const Parameter& parameter, double value) {
  return parameter.share ? (value - parameter.nominal) / parameter.doubt
                         : std::log(value / parameter.nominal) / parameter.doubt;
}

double from_search(const Parameter& parameter, double z) {
  const double value = parameter.share ? parameter.nominal + z * parameter.doubt
                                       : parameter.nominal * std::exp(z * parameter.doubt);
  return std::clamp(value, parameter.low, parameter.high);
}

PaperModel turned(PaperModel model, const std::vector<Parameter>& parameters, const Eigen::VectorXd& z) {
  for (std::size_t i = 0; i < parameters.size(); ++i)
    set_value(model, parameters[i].name, from_search(parameters[i], z[static_cast<Eigen::Index>(i)]));
  if (auto& friction = model.stage.effects.stribeck_friction)
    friction->breakaway = std::max(friction->breakaway, friction->sliding);
  follow_stage(model.stage.baseline, model.pi25);
  follow_stage(model.stage.baseline, model.bopp25);
  return model;
}

}  // namespace biopsy::sim::calibration
