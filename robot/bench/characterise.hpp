// biopsy characterise: experiments on a stage without patient and needle.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "drivers/needle_stage_factory.hpp"
#include "robot/bench/naming_round.hpp"
#include "robot/report/study/bench_report.hpp"

namespace biopsy::robot {

struct CharacteriseOptions {
  std::vector<std::string> experiments;  // none: all
  std::string device{drivers::kStageDevices[0]};
  std::filesystem::path model;  // of the simulated stage; empty: the one of rehearsals
  double weight_g = 50.0;
  double drive_scale = 1.0;  // how many times the nominal voltage the stage needs for a depth
  double push_scale = 1.0;   // how many times the nominal push is laid on
  std::uint64_t seed = 1;
  bool dry_run = false;          // prints what would be done
  bool bench = false;            // no patient, no needle
  bool weights_by_hand = false;  // on a real stage: the operator lays weights on under voltage
  std::filesystem::path device_config, commissioning,
      keys;  // of a real stage; keys empty: the user's own set
  std::filesystem::path out;
  std::filesystem::path
      until_named{};  // a model that is compared with what is recorded; empty: no comparison
};

struct Characterisation {
  report::BenchRecord record;       // without runs after a dry run
  bool complete = false;            // every run came to its end, or it was a dry run
  std::vector<NamingRound> rounds;  // with until_named
  std::string text;                 // for a terminal
};

// Carries out the experiments, or tells what they would be. `clearable`: files of an earlier run in the
// output folder. `stop` retracts, and what was recorded is stored. `notify` prints what a person at the stage
// must know at once. Throws ConfigError, with nothing written.
Characterisation characterise(const CharacteriseOptions& options, const std::vector<std::string>& clearable,
                              const std::stop_token& stop,
                              const std::function<void(const std::string&)>& notify);

}  // namespace biopsy::robot
