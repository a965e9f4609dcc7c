// How far a model is from the paper, and from measured runs: a list of residuals whose squares are minimised.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sim/paper/calibration/parameters.hpp"
#include "sim/paper/paper_figure.hpp"
#include "sim/paper/reproduce.hpp"
#include "sim/plant/dataset.hpp"

namespace biopsy::sim::calibration {

struct Question {
  paper::PaperModel start;  // what no parameter turns stays as it is here
  std::vector<Parameter> parameters;
  std::vector<paper::FigureEntry> figures;
  std::vector<RecordedRun> runs;  // measured, open loop
  double reach = 0.0;             // m that 8 kV of 2 Hz must lift 50 g; 0: not asked for
};

// Of the calibrated stage: the 8 mm of Fig. 12 and of the sines, and a little room. The paper's amplifier
// gives 10 kV, this robot 8 kV: a stage that needs more could be simulated but never rehearsed.
inline constexpr double kReach = 8.1e-3;

// Figures that calibration looks at: all that hold for the stage. Fig. 2 holds for any, "beyond" has no
// numbers.
std::vector<paper::FigureEntry> calibrated_figures();

// The rows that count: not what is shown beside them, nor the spring's stiffness as printed.
std::vector<PaperRow> rows_at(const Question& question, const Eigen::VectorXd& z, bool in_parallel);

// How hard a row pulls that is far from being reached. Even: by how far it is, so that a search that begins
// far from everything comes near to most. Robust: hardly more than one that is nearly reached, so that the
// sum of squares counts rows rather than being ruled by the worst.
enum class Pull : std::uint8_t { Even, Robust };

// One entry a row, a measured run and a parameter: 0 where a row is reached with room to spare.
Eigen::VectorXd residuals(const Question& question, const Eigen::VectorXd& z, bool in_parallel,
                          Pull pull = Pull::Robust);

// How the measured runs are followed, in their order.
struct RunFit {
  std::string name;
  double rms = 0.0, span = 0.0;  // m: of what the model is away, and of the run
  bool followed = false;         // to 5 % of its span, as much as weighs like a number's band, or to 0.02 mm
};
std::vector<RunFit> run_fits(const Question& question, const Eigen::VectorXd& z);

// ln(ours/paper) of the number rows in bands, samples of the measured runs in bands, and the parameters' weak
// priors: what standard deviations are taken from.
Eigen::VectorXd readings(const Question& question, const Eigen::VectorXd& z, bool in_parallel);

}  // namespace biopsy::sim::calibration
