// K_p and K_i for a stage: what the paper's 0.8 and 0.005 reach, and which gains do better with margin, on
// the model and on every stage that the model's uncertainty leaves room for. Feed-forward is judged beside
// them, never mixed in.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "sim/paper/paper_figure.hpp"
#include "sim/paper/tuning/margins.hpp"
#include "sim/plant/model_file.hpp"

namespace biopsy::sim::tuning {

// In time, everything of the model included: 2 to 8 mm and back, and the sine of Fig. 9b.
struct Score {
  double settled_rmse = 0.0;  // mm
  double overshoot = 0.0;     // of the rising edge, % of the target
  double undershoot = 0.0;    // below the target of the falling edge, % of the step; not part of the cost
  double settling = 0.0;      // s until plate A stays within 0.3 mm, the slower of both edges
  double sine_rmse = 0.0;     // mm
  double highest = 0.0;       // kV that were asked for

  // In units of what the paper reports of its own stage: 0.077 mm, 10 %, 1 s and 0.211 mm. What the search
  // makes small.
  double cost() const { return settled_rmse / 0.077 + overshoot / 10.0 + settling / 1.0 + sine_rmse / 0.211; }
};

// Worst of both, entry by entry.
Score worse(const Score& a, const Score& b);

struct Judged {
  std::string name;
  control::PiGains gains;
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
  int grid = 13;              // values of each gain that the search begins with
  std::stop_token stop = {};  // ends the search with the best gains until then
};

struct Tuning {
  std::vector<double> depths;       // mm, at which the stage was made linear
  std::vector<std::string> varied;  // numbers that were uncertain
  bool assumed = false;             // by 10 %, the model file knowing nothing better
  bool correlated = false;          // drawn with the file's correlations; otherwise each for itself
  int stages = 0;                   // that were drawn, besides the model
  int refused = 0;                  // draws that do not settle as the paper's stage does, with its gains
  Requirements wanted;
  bool interrupted = false;  // before the search was complete; feed-forward is not judged then
  bool met = false;  // some gains have the margins on all of them; otherwise the tuned ones come closest
  std::vector<Judged> judged;  // the paper's gains, the tuned ones, each again with feed-forward
  std::vector<FigurePanel> panels;
};

// Between 0 and 1, from the calling thread.
using TuneProgress = std::function<void(double share, const std::string& what)>;

// Deterministic. The run's weight is 50 g, as in the paper. Throws ConfigError where the model cannot be
// driven with volts or has not the stroke.
Tuning tune(const NotedModel& model, const TuneOptions& options = {}, const TuneProgress& progress = {});

}  // namespace biopsy::sim::tuning
