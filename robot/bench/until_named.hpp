// Which experiment of a session comes next, by what the search for missing effects finds in those recorded.
#pragma once

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "robot/bench/bench_session.hpp"
#include "robot/bench/naming_round.hpp"
#include "sim/gap/find_gap.hpp"
#include "sim/plant/dataset.hpp"

namespace biopsy::robot {

// An effect counts as named where it closes the gap down to the noise, nothing else is more than 5 %
// probable, and a second experiment confirmed it: the one that separates it best from the next best
// explanation. Where nothing is missing so far, or nothing fits, the experiments go on in their order, and
// end with the last.
class UntilNamed {
 public:
  // Throws ConfigError where the model cannot be read or has no stack.
  UntilNamed(const BenchSession& session, const std::filesystem::path& model, std::stop_token stop);

  // Indices of session.runs to carry out next; empty: the campaign is over. `recorded`: all so far.
  std::vector<std::size_t> next(const sim::Dataset& recorded);

  const std::vector<NamingRound>& rounds() const { return rounds_; }

 private:
  struct Choice {
    std::string experiment, why;  // no experiment: the end
  };

  Choice choose(const sim::gap::FoundGap& found) const;
  Choice confirming(const sim::gap::FoundGap& found) const;
  Choice separating(const std::vector<sim::gap::FoundGap::Rival>& rivals, double noise_mm) const;
  Choice in_order(const std::string& why) const;
  std::vector<std::size_t> runs_of(const std::string& experiment);

  const BenchSession& session_;
  sim::PlantModel model_;
  std::stop_token stop_;
  std::vector<std::string> left_;  // experiments, in their order
  std::string last_;
  std::vector<NamingRound> rounds_;
};

// RMS of the difference between what two models predict for a run, m.
double predicted_difference(const BenchRun& run, const sim::PlantModel& a, const sim::PlantModel& b);

// The runs of a campaign in words, for a terminal.
std::string to_text(const std::vector<NamingRound>& rounds);

}  // namespace biopsy::robot
