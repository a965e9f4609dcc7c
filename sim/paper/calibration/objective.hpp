// Residuals of a model against the paper and measured runs; their sum of squares is minimised.
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
  paper::PaperModel start;  // values that no parameter sets stay
  std::vector<Parameter> parameters;
  std::vector<paper::FigureEntry> figures;
  std::vector<RecordedRun> runs;  // measured, open loop
  double reach = 0.0;             // m that 8 kV of 2 Hz must lift 50 g; 0: not required
};

// Of the calibrated stage: the 8 mm of Fig. 12 and of the sines, with a margin. The paper's amplifier gives
// 10 kV, this robot 8 kV: a stage that needs more could not be rehearsed.
inline constexpr double kReach = 8.1e-3;

// All figures with rows to fit: not Fig. 2, not Fig. 4 and not "beyond".
std::vector<paper::FigureEntry> calibrated_figures();

// The rows that are fitted (is_fitted).
std::vector<PaperRow> rows_at(const Question& question, const Eigen::VectorXd& z, bool in_parallel);

// Loss of a row that is far from being met. Even: proportional to the distance, for a search from far away.
// Robust: saturating, so that the sum of squares approximates the number of rows missed and is not dominated
// by the worst.
enum class Pull : std::uint8_t { Even, Robust };

// One entry per row, measured run and parameter: 0 where a row is met with margin.
Eigen::VectorXd residuals(const Question& question, const Eigen::VectorXd& z, bool in_parallel,
                          Pull pull = Pull::Robust);

// Fit of the measured runs, in their order.
struct RunFit {
  std::string name;
  double rms = 0.0, span = 0.0;  // m: of the error, and range of the run
  bool followed = false;  // rms <= 5 % of the span, which is weighted like a number's band, or <= 0.02 mm
};
std::vector<RunFit> run_fits(const Question& question, const Eigen::VectorXd& z);

// ln(ours/paper) of the number rows in bands, samples of the measured runs in bands, and the parameters'
// priors: the residuals of which standard deviations are taken.
Eigen::VectorXd readings(const Question& question, const Eigen::VectorXd& z, bool in_parallel);

}  // namespace biopsy::sim::calibration
