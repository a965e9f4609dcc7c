#include "tests/sim/gap/generator/hidden_cases.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "tests/sim/gap/generator/hidden_catalogue.hpp"

namespace biopsy::hidden {
namespace {

using Cases = std::vector<HiddenCase>;

HiddenCase single(const std::string& name, bool visible, std::uint64_t seed) {
  HiddenCase out;
  out.name = name + (visible ? "/visible" : "/strong");
  out.group = "singles";
  out.kind = HiddenKind::Single;
  out.visible = visible;
  out.terms = {{name, visible ? catalogue_entry(name).visible : catalogue_entry(name).strong}};
  out.seed = seed;
  out.plate_b = seed % 3 != 0;
  out.current = seed % 2 != 0;
  return out;
}

HiddenCase variant(const std::string& effect, const std::string& group, const std::string& tag,
                   std::uint64_t seed) {
  HiddenCase out = effect.empty() ? HiddenCase{} : single(effect, false, seed);
  out.name = (effect.empty() ? std::string("nothing") : effect) + "/" + tag;
  out.group = group;
  out.seed = seed;
  return out;
}

void add_singles(Cases& out) {
  std::uint64_t seed = 100;
  for (const CatalogueEntry& e : library_effects())
    for (const bool visible : {true, false}) out.push_back(single(e.name, visible, seed++));
}

void add_pairs(Cases& out) {
  constexpr const char* pairs[][2] = {
      {"coulomb_friction", "charge_retention"}, {"zipping_hysteresis", "pouch_creep"},
      {"external_force", "sensor_lag"},         {"polarity_asymmetry", "quadratic_damping"},
      {"added_mass", "amplifier_lag"},          {"coulomb_friction", "sensor_drift"},
      {"layer_puncture", "shaft_friction"},     {"end_stop", "sensor_offset"},
      {"residual_set", "hysteretic_spring"},    {"periodic_disturbance", "coulomb_friction"}};
  std::uint64_t seed = 300;
  for (const auto& [first, second] : pairs) {
    HiddenCase pair = variant("", "pairs", std::string(second), seed++);
    pair.name = std::string(first) + "+" + second;
    pair.kind = HiddenKind::Pair;
    for (const char* name : {first, second}) pair.terms.push_back({name, catalogue_entry(name).strong});
    out.push_back(pair);
  }
}

void add_parameters(Cases& out) {
  const std::vector<std::vector<WrongParameter>> wrong{{{"K", 0.86 / 0.80}},
                                                       {{"tau", 4.0 / 6.9}},
                                                       {{"k", 200.0 / 140.0}},
                                                       {{"c_s", 2.0}},
                                                       {{"V0", 0.90}},
                                                       {{"tau_h", 1.5}},
                                                       {{"K", 0.93}, {"c_s", 1.6}},
                                                       {{"k", 1.3}, {"tau", 0.7}},
                                                       {{"V0", 1.08}, {"tau_h", 0.7}}};
  std::uint64_t seed = 400;
  for (const auto& set : wrong) {
    HiddenCase next = variant("", "parameters", "", seed++);
    next.name = "wrong";
    for (const WrongParameter& one : set) next.name += " " + one.name;
    next.kind = HiddenKind::Parameter;
    next.parameter_error = 0.0;
    next.wrong = set;
    out.push_back(next);
  }
}

void add_nothing(Cases& out) {
  for (std::uint64_t i = 0; i < 20; ++i) {
    HiddenCase none = variant(
        "", "nothing", i % 2 ? "small-errors-" + std::to_string(i) : "exact-" + std::to_string(i), 500 + i);
    none.parameter_error = i % 2 ? 0.015 : 0.0;
    none.noise_um = i % 5 == 3 ? 1.0 : i % 5 == 4 ? 50.0 : 10.0;
    none.noise_given = i % 3 != 2;
    out.push_back(none);
  }
}

void add_outside(Cases& out) {
  std::uint64_t seed = 600;
  for (const CatalogueEntry& e : outside_effects())
    for (const bool visible : {true, false}) {
      HiddenCase next = single(e.name, visible, seed++);
      next.group = "outside";
      next.kind = HiddenKind::Outside;
      out.push_back(next);
    }
}

void add_recordings(Cases& out) {  // other rates, noises, numbers of runs, missing columns
  std::uint64_t seed = 700;
  const auto add = [&](const char* effect, const char* group, const char* tag, auto change) {
    HiddenCase next = variant(effect, group, tag, seed++);
    change(next);
    out.push_back(next);
  };
  for (const char* effect :
       {"coulomb_friction", "zipping_hysteresis", "pouch_creep", "external_force", "voltage_saturation", ""})
    add(effect, "rate", "100Hz", [](HiddenCase& c) { c.period = 10e-3; });
  for (const char* effect : {"coulomb_friction", "quadratic_damping", "sensor_scale"})
    add(effect, "noise", "1um", [](HiddenCase& c) { c.noise_um = 1.0; });
  for (const char* effect : {"coulomb_friction", "zipping_hysteresis", "sensor_drift", "added_mass"})
    add(effect, "noise", "50um", [](HiddenCase& c) { c.noise_um = 50.0; });
  for (const char* effect : {"coulomb_friction", "charge_retention", "end_stop", ""})
    add(effect, "runs", "two", [](HiddenCase& c) { c.runs = 2; });
  for (const char* effect : {"polarity_asymmetry", "backlash", ""})
    add(effect, "runs", "eight", [](HiddenCase& c) { c.runs = 8; });
  for (const char* effect : {"coulomb_friction", "layer_puncture", "sensor_offset", "amplifier_lag"})
    add(effect, "columns", "bare", [](HiddenCase& c) { c.noise_given = c.plate_b = c.current = false; });
}

void add_force(Cases& out) {
  constexpr std::pair<const char*, double> terms[] = {
      {"coulomb_friction", 0.03},  {"coulomb_friction", 0.15},  {"quadratic_damping", 10.0},
      {"quadratic_damping", 60.0}, {"spring_hardening", 6e6},   {"spring_hardening", 25e6},
      {"hysteretic_spring", 0.08}, {"hysteretic_spring", 0.30}, {"external_force", 0.05},
      {"external_force", 0.20}};
  std::uint64_t seed = 800;
  for (std::size_t i = 0; i < std::size(terms); ++i) {
    HiddenCase next = variant(terms[i].first, "force", i % 2 ? "force-strong" : "force-visible", seed++);
    next.force_drive = true;
    next.visible = i % 2 == 0;
    next.terms = {{terms[i].first, terms[i].second}};
    out.push_back(next);
  }
  for (const char* tag : {"force-exact", "force-small-errors"}) {
    HiddenCase none = variant("", "force", tag, seed++);
    none.force_drive = true;
    none.parameter_error = none.name.ends_with("exact") ? 0.0 : 0.015;
    out.push_back(none);
  }
}

}  // namespace

std::vector<std::string> HiddenCase::expected() const {
  std::vector<std::string> names;
  if (kind != HiddenKind::Outside)
    for (const HiddenTerm& term : terms) names.push_back(term.name);
  return names;
}

std::vector<TrueParameter> HiddenCase::truth() const {
  std::vector<TrueParameter> out;
  for (const HiddenTerm& term : terms)
    for (const Comparable& same : catalogue_entry(term.name).same)
      if (same.name) out.push_back({term.name, same.name, same.fixed + same.unit * term.strength});
  return out;
}

HiddenPhysics HiddenCase::physics() const {
  HiddenPhysics out;
  for (const HiddenTerm& term : terms) catalogue_entry(term.name).set(out, term.strength);
  return out;
}

std::vector<HiddenCase> hidden_cases() {
  Cases out;
  add_singles(out);
  add_pairs(out);
  add_parameters(out);
  add_nothing(out);
  add_outside(out);
  add_recordings(out);
  add_force(out);
  return out;
}

std::vector<HiddenCase> quick_cases() {
  constexpr const char* chosen[] = {"coulomb_friction/visible",
                                    "zipping_hysteresis/strong",
                                    "charge_retention/strong",
                                    "voltage_saturation/visible",
                                    "polarity_asymmetry/visible",
                                    "layer_puncture/strong",
                                    "sensor_drift/visible",
                                    "added_mass/strong",
                                    "coulomb_friction+charge_retention",
                                    "wrong K",
                                    "wrong k tau",
                                    "nothing/exact-0",
                                    "nothing/small-errors-1",
                                    "nothing/exact-2",
                                    "random_shocks/strong",
                                    "cyclic_reading_error/strong",
                                    "speckle_wander/strong",
                                    "external_force/100Hz",
                                    "coulomb_friction/two",
                                    "coulomb_friction/force-visible"};
  const Cases all = hidden_cases();
  Cases out;
  for (const std::string name : chosen) {
    HiddenCase hidden = *std::ranges::find(all, name, &HiddenCase::name);
    hidden.length = 0.5;
    hidden.runs = std::min(hidden.runs, 4);
    out.push_back(std::move(hidden));
  }
  return out;
}

HiddenCase reseeded(HiddenCase hidden, std::uint64_t seed) {
  hidden.seed = hidden.seed * 1000 + seed;
  hidden.name += "#" + std::to_string(seed);
  return hidden;
}

std::vector<std::string> hidden_effect_names() {
  std::vector<std::string> out;
  for (const CatalogueEntry& e : library_effects()) out.emplace_back(e.name);
  return out;
}

std::vector<std::string> outside_names() {
  std::vector<std::string> out;
  for (const CatalogueEntry& e : outside_effects()) out.emplace_back(e.name);
  return out;
}

}  // namespace biopsy::hidden
