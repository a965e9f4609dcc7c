// How far a model is from the paper, and from measured runs: a list of residuals whose squares are minimised.
#pragma once

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "robot/messages/paper_figure.hpp"
#include "sim/calibration/knobs.hpp"
#include "sim/dataset.hpp"
#include "sim/paper/reproduce.hpp"

namespace biopsy::sim::calibration {

struct Question {
  paper::PaperModel start;  // what no knob turns stays as it is here
  std::vector<Knob> knobs;
  std::vector<paper::FigureEntry> figures;
  std::vector<RecordedRun> runs;  // measured, open loop
};

// Figures that calibration looks at: all that hold for the stage. Fig. 2 holds for any, "beyond" has no
// numbers.
std::vector<paper::FigureEntry> calibrated_figures();

// The rows that count: not what is shown beside them, nor the spring's stiffness as printed.
std::vector<PaperRow> rows_at(const Question& question, const Eigen::VectorXd& z, bool in_parallel);

// One entry a row, a measured run and a knob: 0 where a row is reached with room to spare, and levelling off
// where much is missing, so that the sum of squares counts rows rather than being ruled by the worst.
Eigen::VectorXd residuals(const Question& question, const Eigen::VectorXd& z, bool in_parallel);

// ln(ours/paper) of the number rows in bands, samples of the measured runs in bands, and the knobs' weak
// priors: what standard deviations are taken from.
Eigen::VectorXd readings(const Question& question, const Eigen::VectorXd& z, bool in_parallel);

}  // namespace biopsy::sim::calibration
