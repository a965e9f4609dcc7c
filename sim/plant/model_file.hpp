// Model files (docs/reference/model-files.md): TOML with [baseline] and one [effect.NAME] per effect that is
// present; [term.NAME] for a force without one; every value a number or { value, std, source }; and
// [correlation] between values. Refuses unknown
// names, missing values and numbers out of range, naming file, line and what is allowed. model_text.hpp
// writes them.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/plant/plant_model.hpp"

namespace biopsy::sim {

inline constexpr double kReferencePeriod = 1e-3;  // s, T of docs/explanation/model.md, section 1

// Uncertainty and source of a value.
struct ValueNote {
  std::optional<double> std;  // in the unit of the file
  std::string source;

  bool operator==(const ValueNote&) const = default;
};

// Correlation coefficients of the values' errors, for each value with those before it.
struct Correlations {
  std::vector<std::string> values;  // as in ModelNotes::values; each has a std
  std::vector<double> lower;        // below the diagonal, row by row: (2,1), (3,1), (3,2), ...

  double between(std::size_t i, std::size_t j) const {
    if (i == j) return 1.0;
    return i > j ? lower[i * (i - 1) / 2 + j] : between(j, i);
  }
  bool operator==(const Correlations&) const = default;
};

// Contents of a model file besides the model.
struct ModelNotes {
  std::string title;
  std::optional<double> T = kReferencePeriod;  // s, control period; no run depends on it
  std::map<std::string, ValueNote> values;     // by "K", "coulomb_friction.force_N" or "TERM.a"
  std::optional<Correlations> correlations;    // none: not determined

  bool operator==(const ModelNotes&) const = default;
};

struct NotedModel {
  PlantModel model;
  ModelNotes notes;
};

NotedModel read_noted_model(const std::filesystem::path& file);
// The same from text; `name` stands for the file in messages.
NotedModel parse_noted_model(const std::string& text, const std::string& name);

// The model alone.
PlantModel read_model(const std::filesystem::path& file);
PlantModel parse_model(const std::string& text, const std::string& name);

}  // namespace biopsy::sim
