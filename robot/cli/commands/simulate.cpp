// biopsy simulate: recorded inputs through the plant.
#include "sim/plant/simulate.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "robot/cli/command.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/progress.hpp"
#include "sim/plant/model_file.hpp"

namespace biopsy::robot {
namespace simulate_cli {

struct Options {
  std::filesystem::path dataset, model, out;
};

void declare(CLI::App& app, Options& options) {
  add(app, "DATASET", options.dataset, "folder of a [data set](model-files.md#data-set)")->required();
  add_model(app, options.model, "[model file](model-files.md#model)")->required();
  add_out(app, options.out, "the simulated data set")->required();
}

double rms_difference_mm(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(a.size())) * 1e3;
}

Result run(const Options& options, const Context&) {
  const sim::PlantModel model = sim::read_model(options.model);
  const sim::Drive drive = model.baseline.drive;
  const sim::Dataset recorded = sim::read_dataset(options.dataset, drive);
  FileNames files{"dataset.toml"};
  for (const sim::RecordedRun& run : recorded.runs) files.push_back(run.file);
  make_output_folder(options.out, {options.model, options.dataset}, files);
  sim::Dataset simulated = recorded;
  simulated.title = recorded.title + " (simulated)";
  std::string text =
      fmt::format("{:<32} {:>8} {:>9} {:>22}\n", "run", "rows", "time, s", "rms to measured, mm");
  nlohmann::ordered_json runs = nlohmann::ordered_json::array();
  {
    ProgressLine line;
    for (std::size_t i = 0; i < recorded.runs.size(); ++i) {
      const sim::RecordedRun& run = recorded.runs[i];
      line.show(static_cast<double>(i) / static_cast<double>(recorded.runs.size()), run.name);
      simulated.runs[i] = sim::simulate(model, run);
      const double seconds = run.period * static_cast<double>(run.time.size());
      const double rms_mm = rms_difference_mm(run.displacement, simulated.runs[i].displacement);
      text += fmt::format("{:<32} {:>8} {:>9.2f} {:>22.4f}\n", run.name, run.time.size(), seconds, rms_mm);
      runs.push_back(
          {{"name", run.name}, {"rows", run.time.size()}, {"seconds", seconds}, {"rms_mm", rms_mm}});
    }
  }
  for (const sim::RecordedRun& run : simulated.runs)
    atomic_write(options.out / run.file, sim::run_csv(run, drive));
  atomic_write(options.out / "dataset.toml", sim::dataset_toml(simulated));
  text += fmt::format("\nsimulated data set: {}\n", options.out.string());
  return {.text = text,
          .json = nlohmann::ordered_json{{"dataset", options.out.string()}, {"runs", runs}}.dump(2) + "\n"};
}

}  // namespace simulate_cli

Command simulate_command() {
  using namespace simulate_cli;
  return {.name = "simulate",
          .summary = "run the recorded inputs of a data set through a model",
          .examples = {"biopsy simulate docs/examples/recorded --model sim/models/baseline.toml "
                       "--out out/simulated"},
          .exit_codes = "0, or 2 for unusable input",
          .outputs = {{"dataset.toml", "the runs, as in the data set that was given"},
                      {"*.csv", "one run; its name is that of the recorded one"}},
          .json =
              "`dataset`, the folder, and `runs`: list of `name`, `rows`, `seconds` and `rms_mm`, the "
              "difference to the measured displacement",
          .declare = with_options(declare, run)};
}

}  // namespace biopsy::robot
