// K_p and K_i for a stage: performance of the paper's gains, and gains that perform better with the required
// margins, on the model and on stages drawn from its uncertainty. Feed-forward is evaluated separately.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "sim/paper/paper_figure.hpp"
#include "sim/paper/tuning/margins.hpp"
#include "sim/plant/model_file.hpp"

namespace biopsy::sim::tuning {

// Simulated in time with the full model: 2 to 8 mm and back, and the sine of Fig. 9b.
struct Score {
  double settled_rmse = 0.0;  // mm
  double overshoot = 0.0;     // of the rising edge, % of the target
  double undershoot = 0.0;    // below the target of the falling edge, % of the step; not part of the cost
  double settling = 0.0;      // s until plate A stays within 0.3 mm, the slower of both edges
  double sine_rmse = 0.0;     // mm
  double highest = 0.0;       // kV commanded

  // Cost of the search, in units of what the paper reports: 0.077 mm, 10 %, 1 s and 0.211 mm.
  double cost() const { return settled_rmse / 0.077 + overshoot / 10.0 + settling / 1.0 + sine_rmse / 0.211; }
};

// The worse of both, entry by entry.
Score worse(const Score& a, const Score& b);

struct EvaluatedGains {
  std::string name;
  PiGains gains;
  bool feed = false;              // feed-forward from the nominal model,
  double speed = 0.0;             // and then mm/s that the target moves at most
  std::vector<Margins> at_depth;  // of the model, one a depth; feed-forward does not change them
  Margins worst_margins;          // over depths and uncertain stages
  Score nominal, worst;
};

struct TuneOptions {
  int stages = 24;  // uncertain ones, besides the model itself
  std::uint64_t seed = 1;
  Requirements wanted;
  int grid = 13;              // values of each gain in the first grid
  std::stop_token stop = {};  // ends the search with the best gains until then
};

struct Tuning {
  std::vector<double> depths;       // mm, about which the stage was linearised
  std::vector<std::string> varied;  // numbers that were uncertain
  bool assumed = false;             // by 10 %, the model file having no standard deviations
  bool correlated = false;          // drawn with the file's correlations; otherwise independently
  int stages = 0;                   // drawn, besides the model
  int refused = 0;  // rejected draws: with the paper's gains they do not settle as its stage does
  Requirements wanted;
  bool interrupted = false;  // before the search was complete; feed-forward is not evaluated then
  bool met = false;          // the tuned gains have the margins on all stages; otherwise they come closest
  std::vector<EvaluatedGains> evaluated;  // the paper's gains, the tuned ones, each again with feed-forward
  // Gains near the paper's that are better in one respect and worse in none; nothing where none were found.
  std::optional<EvaluatedGains> improved = std::nullopt;
  std::vector<FigurePanel> panels;
};

// Between 0 and 1, from the calling thread.
using TuneProgress = std::function<void(double share, const std::string& what)>;

// Deterministic. The run's weight is 50 g, as in the paper. Throws ConfigError where the model cannot be
// driven with volts or has not the stroke.
Tuning tune(const NotedModel& model, const TuneOptions& options = {}, const TuneProgress& progress = {});

}  // namespace biopsy::sim::tuning
