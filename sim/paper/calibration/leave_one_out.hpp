// Each figure of the paper predicted by a calibration on all others.
#pragma once

#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "sim/paper/calibration/calibrate.hpp"
#include "sim/paper/calibration/gradient_steps.hpp"
#include "sim/paper/held_out.hpp"

namespace biopsy::sim::calibration {

// "9" of "9a"; those of the question, in their order.
std::string whole_figure(std::string_view number);
std::vector<std::string> whole_figures(const Question& question);

// The question without a whole figure, and with it alone.
Question without_figure(Question question, std::string_view whole);
Question figure_alone(Question question, std::string_view whole);

// `steps` from the nominal values with Pull::Even, and again with Pull::Robust.
Descent descend_from_nominal(const Question& question, int steps, const std::stop_token& stop = {});

// Figures are left out whole: 9a to 9d together. Each calibration starts at the nominal values, which come
// from other sources than the figures, and takes `steps` with Pull::Even and again with Pull::Robust: a start
// at an earlier result would know what is left out. Without command and digests. After `stop` the remaining
// figures are missing.
paper::HeldOut leave_one_out(const Question& question, int steps, const CalibrationProgress& progress = {},
                             const std::stop_token& stop = {});

}  // namespace biopsy::sim::calibration
