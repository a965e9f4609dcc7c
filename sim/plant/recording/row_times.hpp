// The time stamps of a recording: fixed rate, or made so where the data set says `resample = true`.
#pragma once

#include <string>
#include <vector>

#include "robot/common/files/csv_table.hpp"

namespace biopsy::sim {

// s between rows. Refuses time that stands or goes back, gaps and time stamps that scatter by more than a
// tenth of the period, naming the line; and rates outside 20 Hz to 100 kHz.
double fixed_period(const CsvTable& csv, const std::vector<double>& time);

// The usual step of time stamps that scatter; refuses what interpolation cannot correct: time that stands or
// goes back, and gaps of more than ten steps.
double usual_period(const CsvTable& csv, const std::vector<double>& time);

// `values` at time[0] + k period: between two readings on the straight line (`held`: the earlier value).
std::vector<double> resampled(const std::vector<double>& time, const std::vector<double>& values,
                              double period, bool held);

}  // namespace biopsy::sim
