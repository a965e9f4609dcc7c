// How well the model predicts a figure that it was not fitted to: rows of each figure by a calibration on all
// other figures. Measured once by `biopsy calibrate --leave-one-out` and kept beside the model.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/paper/paper_figure.hpp"

namespace biopsy::sim::paper {

struct HeldOutRow {
  std::string figure, quantity;
  double ours = 0.0;  // NaN where it could not be computed
  bool ok = false;
};

// SHA-256, hexadecimal, of the model's two files.
struct ModelDigests {
  std::string stage, paper;

  bool operator==(const ModelDigests&) const = default;
};
ModelDigests digests_of(const std::filesystem::path& stage, const std::filesystem::path& paper);

struct HeldOut {
  ModelDigests model;   // whose score it stands beside; its values are not those of the rows
  std::string command;  // that measured it
  std::size_t unknowns = 0, numbers = 0, statements = 0;  // fitted with no figure left out
  std::vector<HeldOutRow> rows;
};

std::string held_out_toml(const HeldOut& held_out);
HeldOut read_held_out(const std::filesystem::path& file);  // throws ConfigError

// Writes into each row what the calibration without its figure gives, and what was fitted. Rows that are not
// in `held_out` stay without.
void add_held_out(Reproduction& reproduction, const HeldOut& held_out);

// Writes into each row whether the leakage model alone, the paper's equations without any effect, meets it.
void add_leakage_model(Reproduction& reproduction, const Reproduction& leakage_model);

}  // namespace biopsy::sim::paper
