// The paper's open-loop experiments, sized so that a healthy stage passes them under the supervisor.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "planner/plan/bench_plan.hpp"
#include "robot/control/voltage_program.hpp"

namespace biopsy::robot {

// A push on plate A, downwards, in these ticks of the program.
struct LoadStep {
  std::uint32_t from_tick = 0, to_tick = 0;
  double push_N = 0.0;
};

// The stage that an experiment is sized for.
struct BenchSetup {
  Grams weight{};            // on the fixture
  double drive_scale = 1.0;  // how many times the nominal stage's voltage it needs for a depth
  double push_scale = 1.0;   // how many times the nominal stage's push it bears without a swing
  bool by_hand = false;      // a push is a small weight, laid on and lifted off by the operator on request
};

struct BenchRun {
  std::string name;  // "staircase-50g": also the name of its file
  std::string what;  // a sentence for the operator
  BenchSetup setup;
  control::VoltageProgram program;
  std::vector<LoadStep> loads;
};

struct Experiment {
  std::string_view name, sentence;
  std::vector<BenchRun> (*runs)(const BenchSetup& setup);
};

const std::vector<Experiment>& experiments();

// The runs of the named experiments, in the order of the list; of all where none is named. Throws ConfigError
// for a name that is not in the list, listing them, and for a setup that the stage cannot lift.
std::vector<BenchRun> runs_of(const std::vector<std::string>& names, const BenchSetup& setup);

inline constexpr double kPushScaleMax = 10.0;

// Input of planner::plan_bench.
planner::BenchRequest bench_request(const BenchRun& run);

double grams_of(double push_N);  // mass whose weight is this push

// N on plate A in this tick of the program.
double push_at(const BenchRun& run, std::uint32_t tick);

}  // namespace biopsy::robot
