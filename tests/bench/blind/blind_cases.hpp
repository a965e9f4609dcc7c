// The sealed cases of the blind challenge: drawn from a seed, written as folders as a laboratory would leave
// them, with the answers in a file of their own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/bench/blind/blind_rig.hpp"

namespace biopsy::blind {

enum class Kind : std::uint8_t { Single, Pair, Nothing, Outside };

struct BlindCase {
  std::string name;  // sealed: never in the folder
  Kind kind = Kind::Nothing;
  std::vector<std::string> effects;  // by the library's names; of Outside: what it is
  std::string variables;             // of Outside: letters of which the proposed term needs one
  bool mass_rig = false;
  std::uint64_t seed = 0;
};

// Every effect of the library twice on the stage, those of mechanics twice on a mass, pairs, nothing, and
// laws outside the library.
std::vector<BlindCase> blind_cases(std::uint64_t seed);

// Writes dataset.toml, one CSV a run and model.toml. Returns how far the hidden thing moves the readings, RMS
// in units of their noise.
double write_case(const BlindCase& one, const std::filesystem::path& folder);

}  // namespace biopsy::blind
