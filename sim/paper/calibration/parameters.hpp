// What calibration may turn: numbers of the paper's model, each with the range that is physically plausible
// and the value to which it is drawn where the paper says nothing.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "sim/paper/paper_model.hpp"

namespace biopsy::sim::calibration {

struct Parameter {
  std::string name;    // as in files: "K", "stribeck_friction.sliding_N", "film.pi25.tau", "joint.mass_g"
  double low, high;    // file units
  double nominal;      // what it is drawn to where the paper says nothing: docs/explanation/model.md or the
                       // effect's page
  double start;        // where the search begins: a first guess from the paper and from earlier searches
  double doubt;        // one standard deviation of what is known beforehand: of ln(value), or of a share
  bool share = false;  // counts in steps of its own, may be 0; all others in factors
  std::string why;     // where nominal and range come from
};

const std::vector<Parameter>& standard_parameters();

// The number a parameter stands for, in file units; an effect that the stage lacks is put there absent: no
// strength, its typical shape.
// Throws ConfigError for a name that nothing has.
double value_of(const paper::PaperModel& model, const std::string& name);
void set_value(paper::PaperModel& model, const std::string& name, double value);

// In units of doubt, 0 at nominal: what the search sees. And back, held within the parameter's range.
double to_search(const Parameter& parameter, double value);
double from_search(const Parameter& parameter, double z);

// The model with all parameters set so. What follows from them: breakaway is at least sliding friction, and
// the other films' K follows the stage's by C2, which goes with eps_film/d_film (same size, same cable).
paper::PaperModel turned(paper::PaperModel model, const std::vector<Parameter>& parameters,
                         const Eigen::VectorXd& z);

}  // namespace biopsy::sim::calibration
