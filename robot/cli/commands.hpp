// What the program can do, one function a command. Each returns the exit code for a run that went its way
// (0), and throws ConfigError for bad input (2, see main).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robot/procedure/procedure_options.hpp"

namespace biopsy::robot {

// Exit code 0: completed; 3: refused or stopped, which is an answer and not an error of use.
int dry_run(const ProcedureOptions& options);
int plan(const ProcedureOptions& options);

struct CheckOptions {
  std::filesystem::path before, after;
  std::string before_series, after_series;
  std::string entry, axis;            // "R,A,S" in mm; the axis is a direction of any length
  std::optional<double> expected_mm;  // planned depth
  double tip_offset_mm = 0.0;
  std::filesystem::path out;  // empty: no files
  bool json = false;
};

// Exit code 0 for any honest verdict.
int check(const CheckOptions& options);

struct SimulateOptions {
  std::filesystem::path dataset, model, out;
};

int simulate(const SimulateOptions& options);

struct ImageOptions {
  std::filesystem::path path;
  std::string series;
  std::filesystem::path png;  // folder for pictures; empty: none
};

int image(const ImageOptions& options);

struct EffectsOptions {
  std::string name;       // empty: all
  bool json = false;      // for programs
  bool markdown = false;  // docs/reference/effects.md
};

int effects(const EffectsOptions& options);

struct GapOptions {
  std::filesystem::path dataset, model, out;
  std::vector<std::string> free;  // baseline parameters that are not known
  std::optional<double> window;   // s; empty: each run from its start in one piece
  bool accept = false;            // the model file is replaced by what was found
  bool recheck = true;            // rehearse with the model that was found
};

// Exit code 0 for any honest verdict.
int gap(const GapOptions& options);

struct ReproduceOptions {
  std::string figure;           // "6", "7a", "9" for all its parts; empty: all
  std::filesystem::path model;  // empty: sim/models/calibrated.toml
  std::filesystem::path out;
};

// Exit code 0 also where rows are missed: an honest result.
int reproduce(const ReproduceOptions& options);

struct CalibrateOptions {
  std::filesystem::path model;  // empty: sim/models/calibrated.toml
  std::filesystem::path out;
  std::vector<std::filesystem::path> data;  // measured runs that count beside the paper's rows
  int evaluations = 0;                      // of each search; 0: 600, or 1600 from nominal values
  std::uint64_t seed = 1;
  bool from_nominal = false;  // begin at what was known beforehand, not at earlier answers
};

int calibrate(const CalibrateOptions& options);

struct IdentifyOptions {
  std::filesystem::path dataset, model, out;  // model empty: sim/models/baseline.toml
};

int identify(const IdentifyOptions& options);

struct DesignOptions {
  std::filesystem::path model, out;  // model empty: sim/models/calibrated.toml
  std::uint64_t seed = 1;
};

int design(const DesignOptions& options);

struct SafetyCaseOptions {
  std::filesystem::path out;
  std::filesystem::path collect;  // evidence gathered earlier; empty: run everything
  bool quick = false;             // the short subset
};

// Exit code 0: no gap; 3: the case does not hold.
int safety_case(const SafetyCaseOptions& options);

struct TuneOptions {
  std::filesystem::path model, out;  // model empty: sim/models/calibrated.toml; out empty: no files
  int stages = 24;                   // that the model's uncertainty leaves room for
  std::uint64_t seed = 1;
};

int tune(const TuneOptions& options);

}  // namespace biopsy::robot
