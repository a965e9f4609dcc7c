// biopsy design: which stacks are better than the paper's, and at what price.
#include <fmt/format.h>

#include "robot/cli/commands.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/data_folder.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/progress.hpp"
#include "robot/procedure/case.hpp"
#include "robot/report/study/design_report.hpp"
#include "sim/paper/design/design_study.hpp"
#include "sim/plant/model_file.hpp"

namespace biopsy::robot {
namespace {

DesignStudy studied(const sim::PlantModel& model, const std::string& name, std::uint64_t seed) {
  ProgressLine line;
  return sim::design::study_designs(model, name, {}, {.seed = seed},
                                    [&line](double share) { line.show(share, "designs"); });
}

}  // namespace

int design(const DesignOptions& options) {
  const std::filesystem::path file =
      options.model.empty() ? data_folder() / "sim/models/calibrated.toml" : options.model;
  const sim::PlantModel model = sim::read_model(file);
  if (model.baseline.drive != sim::Drive::Stack)
    throw ConfigError("this model has no stack of pouches (drive = \"force\")", file.string(),
                      "give the model of a stage that voltage drives");
  claim_run_folder(options.out, {file});
  const std::string name = options.model.empty() ? "sim/models/calibrated.toml" : options.model.string();
  const DesignStudy study = studied(model, name, options.seed);
  report::save_design(study, options.out);
  fmt::print("{}", report::design_console(study));
  fmt::print("\nreport:  {}\ndesigns: {}\n", (options.out / "report.html").string(),
             (options.out / "design.json").string());
  return 0;
}

}  // namespace biopsy::robot
