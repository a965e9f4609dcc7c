// Hidden cases: what is hidden, the expected result, and how the data were taken.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/sim/gap/generator/hidden_physics.hpp"

namespace biopsy::hidden {

enum class HiddenKind : std::uint8_t { Single, Pair, Parameter, Nothing, Outside };

struct HiddenTerm {  // one thing that is added, `strength` in SI of its first number
  std::string name;
  double strength = 0.0;
};

struct WrongParameter {
  std::string name;  // of the baseline
  double factor = 1.0;
};

// A number that means the same thing in the library, in the unit of model files.
struct TrueParameter {
  std::string effect, parameter;
  double value = 0.0;
};

struct HiddenCase {
  std::string name,
      group;  // group: singles, pairs, parameters, nothing, outside, rate, noise, runs, columns, force
  HiddenKind kind = HiddenKind::Nothing;
  std::vector<HiddenTerm> terms;
  std::vector<WrongParameter> wrong;
  std::uint64_t seed = 1;
  double noise_um = 10.0, period = 1e-3, length = 1.0;  // length scales the duration of the runs
  int runs = 6;
  double parameter_error = 0.015;  // K, tau, V0, tau_h, k, c_s, c_k: each within this share; uniform
  bool noise_given = true, plate_b = true, current = true, force_drive = false;
  bool visible = false;  // the weaker of the two strengths

  std::vector<std::string> expected() const;  // effects of the library, empty outside it
  std::vector<TrueParameter> truth() const;
  HiddenPhysics physics() const;
};

std::vector<HiddenCase> hidden_cases();
// Twenty of all kinds for every day: half as long, at most four runs.
std::vector<HiddenCase> quick_cases();
HiddenCase reseeded(HiddenCase hidden, std::uint64_t seed);
std::vector<std::string> hidden_effect_names();  // of the library
std::vector<std::string> outside_names();

}  // namespace biopsy::hidden
