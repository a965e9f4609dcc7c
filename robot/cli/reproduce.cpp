// biopsy reproduce: the paper's experiments on a model.
#include "sim/paper/reproduce.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "robot/cli/commands.hpp"
#include "robot/common/files/data_folder.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/progress.hpp"
#include "robot/procedure/case.hpp"
#include "robot/report/study/reproduction_report.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;

Reproduction reproduced(const sim::paper::PaperModel& model, const std::string& figure) {
  ProgressLine line;
  return sim::paper::reproduce(
      model, figure, [&line](std::size_t done, std::size_t of, std::string_view number) {
        line.show(static_cast<double>(done) / static_cast<double>(of), fmt::format("figure {}", number));
      });
}

}  // namespace

int reproduce(const ReproduceOptions& options) {
  sim::paper::figures_named(options.figure);  // refuses before anything is read or touched
  const fs::path stage = options.model.empty() ? data_folder() / "sim/models/calibrated.toml" : options.model;
  const sim::paper::PaperModel model =
      sim::paper::read_paper_model(stage, data_folder() / "sim/models/paper.toml");
  claim_run_folder(options.out, {stage});
  Reproduction result = reproduced(model, options.figure);
  result.model = options.model.empty() ? "sim/models/calibrated.toml" : options.model.string();
  report::save_reproduction(result, options.out);
  fmt::print("{}", report::reproduction_console(result, isatty(STDOUT_FILENO) == 1));
  fmt::print("\nreport: {}\nrows:   {}\n", (options.out / "report.html").string(),
             (options.out / "reproduce.json").string());
  return 0;
}

}  // namespace biopsy::robot
