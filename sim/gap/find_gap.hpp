// The gap workflow: from a data set and a model to a finding. Residual, its location, candidates, forward
// selection, new model. Deterministic: the same data and model give the same finding.
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
  std::vector<std::string> free;  // baseline parameters fitted without a prior
  std::optional<double> window;   // s, cuts runs into windows that start from the measured motion
  bool choose = true;             // both are taken from the data where neither is given: choose.hpp
  bool free_chosen = false;       // `free` was: the given model is compared as it is
  std::stop_token stop = {};      // ends the search with the result so far
};

// The finding and the new model; standard deviations of its fitted parameters by name, as in model files
// ("K", "coulomb_friction.force_N").
struct FoundGap {
  GapFinding finding;
  PlantModel model;
  struct Source {
    std::string name;
    double std = 0.0;
  };
  std::vector<Source> changed;
  // The strongest effect and the next best candidate, each as fitted: what finding.next would separate. Empty
  // where no effect was selected or nothing competes with it.
  struct Rival {
    std::string name;
    PlantModel model;
  };
  std::vector<Rival> rivals;
  // With the term of finding.proposed; `model` is then the given one.
  std::optional<PlantModel> proposed_model;
  std::vector<Source> proposed_changed;
};

// Throws ConfigError for unusable data and for names in `free` that are no parameter of this drive.
FoundGap find_gap(
    const Dataset& dataset, const PlantModel& model, const SearchOptions& options,
    const Progress& progress = [](double, const std::string&) {});

}  // namespace biopsy::sim::gap
