// biopsy design: which stacks are better than the paper's, and at what price.
#include <fmt/format.h>

#include "robot/cli/command.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/data_folder.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/progress.hpp"
#include "robot/common/text/number_text.hpp"
#include "robot/report/study/design_report.hpp"
#include "sim/paper/design/design_study.hpp"
#include "sim/plant/model_file.hpp"

namespace biopsy::robot {
namespace design_cli {

struct Options {
  std::filesystem::path model, out;  // model empty: sim/models/calibrated.toml
  std::uint64_t seed = 1;
};

void declare(CLI::App& app, Options& options) {
  add_model(app, options.model, "[model](model-files.md#model) of the paper's stack",
            "sim/models/calibrated.toml");
  add_seed(app, options.seed, "the search");
  add_out(app, options.out, "the report")->required();
}

Result run(const Options& options, const Context& context) {
  const std::filesystem::path file =
      options.model.empty() ? data_folder() / "sim/models/calibrated.toml" : options.model;
  const sim::PlantModel model = sim::read_model(file);
  if (model.baseline.drive != sim::Drive::Stack)
    throw ConfigError("this model has no stack of pouches (drive = \"force\")", file.string(),
                      "give the model of a stage that voltage drives");
  claim_run_folder(options.out, {file}, context.clearable);
  const std::string name = options.model.empty() ? "sim/models/calibrated.toml" : options.model.string();
  DesignStudy study;
  {
    ProgressLine line;
    study = sim::design::study_designs(model, name, {}, {.seed = options.seed, .stop = context.interrupted},
                                       [&line](double share) { line.show(share, "designs"); });
  }
  report::save_design(study, options.out);
  std::string text = report::design_console(study);
  if (study.interrupted) text += fmt::format("interrupted after {}\n", counted(study.evaluated, "design"));
  text += fmt::format("\nreport:  {}\ndesigns: {}\n", (options.out / "report.html").string(),
                      (options.out / "design.json").string());
  return {.text = text, .json = report::design_json(study)};
}

}  // namespace design_cli

Command design_command() {
  using namespace design_cli;
  return {.name = "design",
          .summary = "which stacks are better than the paper's, and what they cost",
          .description =
              "Varies oil volume, electrodes, film thickness, number of pouches and spring, and keeps "
              "the Pareto-optimal designs in stroke, ripple, bandwidth, peak field and stack height.",
          .long_examples = {"biopsy design --out out/design"},
          .exit_codes =
              "0, 2 for unusable input, 130 where Ctrl-C ended the search; what was found until then is "
              "written",
          .outputs = {{"report.html", "trade-offs, demands and assumptions"},
                      {"design.json",
                       "`model`, `paper`, `best` (the designs), `demands`, `assumed`, `evaluated` "
                       "(how many), `seconds`; `interrupted` where it was"}},
          .replaces_earlier_run = true,
          .json = "the content of `design.json`",
          .interruptible = true,
          .declare = with_options(declare, run)};
}

}  // namespace biopsy::robot
