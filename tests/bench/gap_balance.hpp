// The balance of forces on plate A as equations for a regression, in weak form (Messenger, Bortz, Multiscale
// Model. Simul. 2021): averaged over short windows, derivatives passed on to a smooth weight, so that noisy
// readings need not be differentiated twice.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "sim/plant/dataset.hpp"

namespace biopsy::bench {

// One reading and what goes with it. SI
struct Sample {
  double t, x, v, u;  // v: slope of a straight line through the readings around
  double x_B;         // as measured, else of the baseline's simulation; 0 without a stack
  double push, mass;  // N down as recorded; kg of plate A
  double pull;        // V on the films, eq. (2)

  double stretch() const { return x_B - x; }
};

struct SampledRun {
  double period = 1e-3;  // s
  std::vector<Sample> samples;
};

SampledRun sampled(const sim::RecordedRun& run, const sim::PlantModel& model);

// A quantity that may be part of the balance, differentiated `order` times. What the library calls it:
// `in_file` is the value of its parameter for a coefficient of 1; no parameter: a number of the baseline, or
// an effect that this quantity only hints at.
struct Column {
  std::string effect, parameter;
  double in_file = 1.0;
  std::function<double(const Sample&)> of;
  int order = 0;
};

std::vector<Column> dictionary(const sim::Baseline& baseline, double frequency);

struct Balance {
  Eigen::MatrixXd columns;
  Eigen::VectorXd left_over, time;  // N, up: what the baseline does not account for; s, middle of the window
};

Balance balance(const std::vector<SampledRun>& runs, const std::vector<Column>& columns,
                const sim::Baseline& baseline);

}  // namespace biopsy::bench
