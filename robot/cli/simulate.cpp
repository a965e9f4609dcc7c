// biopsy simulate: recorded inputs through the plant.
#include "sim/plant/simulate.hpp"

#include <fmt/format.h>

#include <cmath>

#include "robot/cli/commands.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/progress.hpp"
#include "sim/plant/model_file.hpp"

namespace biopsy::robot {
namespace {

double rms_difference_mm(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(a.size())) * 1e3;
}

}  // namespace

int simulate(const SimulateOptions& options) {
  const sim::PlantModel model = sim::read_model(options.model);
  const sim::Drive drive = model.baseline.drive;
  const sim::Dataset recorded = sim::read_dataset(options.dataset, drive);
  keep_apart(options.out, {options.model, options.dataset});
  sim::Dataset simulated = recorded;
  ProgressLine line;
  for (std::size_t i = 0; i < recorded.runs.size(); ++i) {
    line.show(static_cast<double>(i) / static_cast<double>(recorded.runs.size()), recorded.runs[i].name);
    simulated.runs[i] = sim::simulate(model, recorded.runs[i]);
    atomic_write(options.out / simulated.runs[i].file, sim::run_csv(simulated.runs[i], drive));
  }
  simulated.title = recorded.title + " (simulated)";
  atomic_write(options.out / "dataset.toml", sim::dataset_toml(simulated));
  fmt::print("{:<32} {:>8} {:>9} {:>22}\n", "run", "rows", "time, s", "rms to measured, mm");
  for (std::size_t i = 0; i < recorded.runs.size(); ++i) {
    const sim::RecordedRun& run = recorded.runs[i];
    fmt::print("{:<32} {:>8} {:>9.2f} {:>22.4f}\n", run.name, run.time.size(),
               run.period * static_cast<double>(run.time.size()),
               rms_difference_mm(run.displacement, simulated.runs[i].displacement));
  }
  fmt::print("\nsimulated data set: {}\n", options.out.string());
  return 0;
}

}  // namespace biopsy::robot
