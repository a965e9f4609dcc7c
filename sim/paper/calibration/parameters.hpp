// Parameters of calibration: numbers of the paper's model, each with its plausible range and its prior.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "sim/paper/paper_model.hpp"

namespace biopsy::sim::calibration {

struct Parameter {
  std::string name;    // as in files: "K", "stribeck_friction.sliding_N", "film.pi25.tau", "joint.mass_g"
  double low, high;    // file units
  double nominal;      // mean of the prior: docs/explanation/model.md or the effect's page
  double start;        // of the search: from the paper and earlier searches
  double doubt;        // std of the prior: of ln(value), or of a share
  bool share = false;  // normal prior, may be 0; all others have a lognormal one
  std::string why;     // where nominal and range come from
};

const std::vector<Parameter>& standard_parameters();

// Value of a parameter, in file units; an effect that the stage lacks is added with strength 0 and its
// typical shape. Throws ConfigError for an unknown name.
double value_of(const paper::PaperModel& model, const std::string& name);
void set_value(paper::PaperModel& model, const std::string& name, double value);

// In prior stds from nominal, the coordinate of the search; and back, clamped to the parameter's range.
double to_search(const Parameter& parameter, double value);
double from_search(const Parameter& parameter, double z);

// The model with all parameters set. Dependent values: breakaway is at least sliding friction, and
// the other films' K follows the stage's by C2, which goes with eps_film/d_film (same size, same cable).
paper::PaperModel turned(paper::PaperModel model, const std::vector<Parameter>& parameters,
                         const Eigen::VectorXd& z);

}  // namespace biopsy::sim::calibration
