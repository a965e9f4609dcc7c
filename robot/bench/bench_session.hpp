// The runs of one `biopsy characterise`, planned and checked before anything moves.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "robot/bench/characterise.hpp"
#include "robot/bench/experiments.hpp"
#include "robot/msg/plan.hpp"
#include "sim/plant/plant_model.hpp"

namespace biopsy::robot {

struct BenchSession {
  std::filesystem::path model_file;
  sim::PlantModel model;
  std::vector<BenchRun> runs;
  std::vector<Plan> plans;         // one a run
  std::vector<std::string> notes;  // for the report: what was left out or added, and why

  Seconds rest() const;   // at 0 V before each run on a hardware stage
  Volts highest() const;  // of all runs
};

// Throws ConfigError for options that contradict each other, a model without a stack, a run that the planner
// refuses.
BenchSession prepare_session(const CharacteriseOptions& options);

// The table of runs, for --dry-run.
std::string describe_session(const BenchSession& session);

}  // namespace biopsy::robot
