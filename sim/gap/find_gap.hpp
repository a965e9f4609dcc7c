// The whole workflow as a function from a data set and a model to a finding: residual, where, candidates,
// select, confuse, add, show. Deterministic: the same data and model give the same finding.
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "sim/gap/gap_finding.hpp"
#include "sim/gap/select/select.hpp"
#include "sim/plant/dataset.hpp"

namespace biopsy::sim::gap {

struct SearchOptions {
  std::vector<std::string> free;  // names of baseline numbers that are not known
  std::optional<double> window;   // s
  std::stop_token stop = {};      // ends the search with what was found until then
};

// What was found, and the model that comes of it; standard deviations of its new numbers by name, as in
// model files ("K", "coulomb_friction.force_N").
struct FoundGap {
  GapFinding finding;
  PlantModel model;
  struct Source {
    std::string name;
    double std = 0.0;
  };
  std::vector<Source> changed;
};

// Throws ConfigError for data that cannot be used and names that cannot be freed.
FoundGap find_gap(
    const Dataset& dataset, const PlantModel& model, const SearchOptions& options,
    const Progress& progress = [](double, const std::string&) {});

}  // namespace biopsy::sim::gap
