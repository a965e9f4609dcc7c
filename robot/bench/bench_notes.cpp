#include "robot/bench/bench_notes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "planner/plan/bench_plan.hpp"
#include "safety/types/limits.hpp"

namespace biopsy::robot {
namespace {

constexpr double kMoved_mm = 1.0;   // a run that expects less does not lift
constexpr double kAtRest_mm = 0.2;  // between two runs' beginnings: ten times the laser's noise

// Position of plate A before the first voltage, mm.
double began_at(const report::BenchRunRecord& run) {
  double sum = 0.0;
  std::size_t rest = 0;
  while (rest < run.drive_kV.size() && run.drive_kV[rest] == 0.0) sum += run.displacement_mm[rest++];
  return sum / static_cast<double>(std::max<std::size_t>(rest, 1));
}

// The next --drive-scale to try, as advice: all voltages grow with it, and end at 8 kV.
std::string next_scale(Volts highest, double drive_scale) {
  const double most =
      std::min(planner::kDriveScaleMax, drive_scale * from_mV(limits::kDriveMax_mV).value / highest.value);
  const double next = std::floor(10.0 * std::min(most, drive_scale + 0.5)) / 10.0;
  return next > drive_scale ? fmt::format("; the next step would be --drive-scale {:g}", next)
                            : "; there is no more for this weight";
}

}  // namespace

void note_the_beginning(report::BenchRecord& record) {
  const report::BenchRunRecord& run = record.runs.back();
  const double began = began_at(run), first = began_at(record.runs.front());
  if (std::abs(began - first) > kAtRest_mm)
    record.notes.push_back(
        fmt::format("{} began {:+.2f} mm from where {} began: an earlier run has left an offset.", run.name,
                    began - first, record.runs.front().name));
}

void note_the_travel(report::BenchRecord& record, Volts highest, double drive_scale) {
  constexpr double kLittle = 0.3, kMuch = 1.5;
  std::string little, much;
  for (const report::BenchRunRecord& run : record.runs) {
    if (!run.stopped_because.empty() || run.expected_mm < kMoved_mm) continue;
    const double travel =
        *std::max_element(run.displacement_mm.begin(), run.displacement_mm.end()) - began_at(run);
    if (travel < kLittle * run.expected_mm) little += (little.empty() ? "" : ", ") + run.name;
    if (travel > kMuch * run.expected_mm) much += (much.empty() ? "" : ", ") + run.name;
  }
  if (!little.empty())
    record.notes.push_back(fmt::format(
        "Lifted less than a third of the expected travel, so these runs contain little information: {}. "
        "Friction holds the stage at these voltages, or the stack needs more{}.",
        little, next_scale(highest, drive_scale)));
  if (!much.empty())
    record.notes.push_back(
        fmt::format("Lifted more than 1.5 times the expected travel: {}. Check the weight on the fixture{}.",
                    much, drive_scale > 1.0 ? ", and take a smaller --drive-scale" : ""));
}

}  // namespace biopsy::robot
