// Each figure of the paper predicted by a calibration on all others.
#pragma once

#include <stop_token>

#include "sim/paper/calibration/calibrate.hpp"
#include "sim/paper/held_out.hpp"

namespace biopsy::sim::calibration {

// Figures are left out whole: 9a to 9d together. Each calibration starts at the nominal values, which come
// from other sources than the figures, and takes `steps` with Pull::Even and again with Pull::Robust: a start
// at an earlier result would know what is left out. Without command and digests. After `stop` the remaining
// figures are missing.
paper::HeldOut leave_one_out(const Question& question, int steps, const CalibrationProgress& progress = {},
                             const std::stop_token& stop = {});

}  // namespace biopsy::sim::calibration
