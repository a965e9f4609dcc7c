// What a calibration found, which parameters the data tell, and what is missed: as text, JSON and a page.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/paper/calibration/calibrate.hpp"

namespace biopsy::report {

struct CalibrationRun {
  std::string command;  // as in the sources of the model
  std::uint64_t seed = 1;
  double seconds = 0.0;
  std::vector<std::filesystem::path> data;  // folders of measured runs
  std::filesystem::path out;
};

std::string calibration_text(const sim::calibration::Calibration& result, const CalibrationRun& run);
std::string calibration_json(const sim::calibration::Calibration& result, const CalibrationRun& run);
std::string calibration_html(const sim::calibration::Calibration& result, const CalibrationRun& run);

// Share of a parameter's prior variance that the data take away: 0 where they tell nothing of it, towards 1
// where they alone tell it. NaN where the search was interrupted.
double told_by_data(const sim::calibration::CalibratedParameter& found);

}  // namespace biopsy::report
