// Data sets (docs/reference/model-files.md): a folder with dataset.toml and one CSV a run. Refuses missing
// columns, gaps, NaN, time that goes back and wrong units, naming file, line and column.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/plant/plant_model.hpp"

namespace biopsy::sim {

enum class RunRole : std::uint8_t { Unassigned, Train, Test };

// Row k: measured at time[k]; then input[k] is applied and held until the next row.
struct RecordedRun {
  std::string name, file;
  RunRole role = RunRole::Unassigned;
  double weight = 0.0;                 // kg on plate A
  double period = 1e-3;                // s between rows
  std::vector<double> time;            // s
  std::vector<double> input;           // V (Drive::Stack) or N (Drive::Force)
  std::vector<double> displacement;    // m
  std::vector<double> plate_b;         // m, empty where not measured
  std::vector<double> current;         // A, empty where not measured
  std::vector<double> external_force;  // N per row; the run's constant where there is no column
};

struct Dataset {
  std::string title;
  std::optional<double> sensor_noise;  // m
  std::optional<bool> tissue = {};     // whether the needle meets tissue; empty: not said
  std::vector<RecordedRun> runs;
};

Dataset read_dataset(const std::filesystem::path& folder, Drive drive);

// The files of a data set as text: one CSV a run, and dataset.toml.
std::string run_csv(const RecordedRun& run, Drive drive);
std::string dataset_toml(const Dataset& dataset);

}  // namespace biopsy::sim
