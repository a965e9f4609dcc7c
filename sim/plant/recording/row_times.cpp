#include "sim/plant/recording/row_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robot/common/config_error.hpp"
#include "robot/common/statistics.hpp"

namespace biopsy::sim {
namespace {

constexpr double kLongestGap = 10.0;     // steps that may be interpolated
constexpr double kRounding = 0.1;        // of a step
constexpr double kPrinted = 1.1e-6;      // s, times printed to a microsecond
constexpr double kManyIrregular = 0.05;  // of all steps: not a gap, but a clock that scatters

std::vector<double> steps_of(const CsvTable& csv, const std::vector<double>& time) {
  if (time.size() < 2)
    throw ConfigError("fewer than two rows", csv.file(), "a run needs at least two samples");
  std::vector<double> steps;
  for (std::size_t i = 1; i < time.size(); ++i) {
    steps.push_back(time[i] - time[i - 1]);
    if (steps.back() <= 0.0)
      throw ConfigError(
          fmt::format("column `time_s`: time does not go on ({} s after {} s)", time[i], time[i - 1]),
          csv.place(i), "sort the rows and remove repeated ones");
  }
  return steps;
}

void refuse_rate(const CsvTable& csv, double period) {
  if (period < 0.99e-5 || period > 0.0505)
    throw ConfigError(fmt::format("sampled every {:.6g} s", period), csv.file(),
                      "rates from 20 Hz to 100 kHz can be used; if the time is in another unit, say so in "
                      "dataset.toml: [columns] time = { unit = \"ms\" }");
}

}  // namespace

double fixed_period(const CsvTable& csv, const std::vector<double>& time) {
  const std::vector<double> steps = steps_of(csv, time);
  const double usual = median(steps);  // one gap must not make every other step look wrong
  std::size_t first = steps.size(), irregular = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (std::abs(steps[i] - usual) <= std::max(kRounding * usual, kPrinted)) continue;
    first = std::min(first, i);
    ++irregular;
  }
  if (irregular > 0) {
    const bool scatters = static_cast<double>(irregular) > kManyIrregular * static_cast<double>(steps.size());
    throw ConfigError(
        fmt::format("column `time_s`: a step of {:.6g} s where the others take {:.6g} s{}", steps[first],
                    usual,
                    scatters ? fmt::format("; {} of {} steps are irregular", irregular, steps.size())
                             : std::string(": samples are missing")),
        csv.place(first + 1),
        "split the run at the gap, or write `resample = true` in dataset.toml to interpolate at a fixed "
        "rate");
  }
  const double period = (time.back() - time.front()) / static_cast<double>(steps.size());
  refuse_rate(csv, period);
  return period;
}

double usual_period(const CsvTable& csv, const std::vector<double>& time) {
  const std::vector<double> steps = steps_of(csv, time);
  const double usual = median(steps);
  refuse_rate(csv, usual);
  for (std::size_t i = 0; i < steps.size(); ++i)
    if (steps[i] > kLongestGap * usual)
      throw ConfigError(fmt::format("column `time_s`: a gap of {:.6g} s where the other steps take {:.6g} s",
                                    steps[i], usual),
                        csv.place(i + 1), "split the run at the gap");
  return usual;
}

std::vector<double> resampled(const std::vector<double>& time, const std::vector<double>& values,
                              double period, bool held) {
  std::vector<double> out;
  const auto rows = static_cast<std::size_t>((time.back() - time.front()) / period + 1e-6) + 1;
  out.reserve(rows);
  std::size_t at = 0;
  for (std::size_t row = 0; row < rows; ++row) {
    const double now = time.front() + static_cast<double>(row) * period;
    while (at + 2 < time.size() && time[at + 1] <= now) ++at;
    const double share = std::clamp((now - time[at]) / (time[at + 1] - time[at]), 0.0, 1.0);
    const double line = values[at] + share * (values[at + 1] - values[at]);
    out.push_back(held ? values[share < 1.0 ? at : at + 1] : line);
  }
  return out;
}

}  // namespace biopsy::sim
