#include "robot/cli/commands/gap_paper.hpp"

#include <fmt/format.h>

#include <chrono>

#include "robot/common/files/data_folder.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/progress.hpp"
#include "robot/report/study/missing_report.hpp"
#include "sim/paper/missing/find_missing.hpp"

namespace biopsy::robot {

Result gap_paper(std::filesystem::path model, const std::vector<std::string>& candidates,
                 const std::filesystem::path& out, const Context& context) {
  const std::vector<sim::missing::Candidate> tried = sim::missing::paper_candidates(candidates);
  const std::filesystem::path models = data_folder() / "sim/models";
  if (model.empty()) model = models / "calibrated.toml";
  sim::calibration::Question question;
  question.start = sim::paper::read_paper_model(model, models / "paper.toml");
  question.parameters = sim::calibration::standard_parameters();
  question.figures = sim::calibration::calibrated_figures();
  question.reach = sim::calibration::kReach;
  claim_run_folder(out, {model}, context.clearable);
  const auto started = std::chrono::steady_clock::now();
  ProgressLine line;
  const sim::missing::MissingInPaper found = sim::missing::find_missing(
      question, tried, {.stop = context.interrupted},
      [&line](double share, const std::string& doing) { line.show(share, doing); });
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  const std::string json = report::missing_json(found, seconds);
  atomic_write(out / "paper_gap.json", json);
  atomic_write(out / "report.html", report::missing_html(found));
  return {.text = report::missing_text(found) + fmt::format("\nreport: {}\nvalues: {}\n",
                                                            (out / "report.html").string(),
                                                            (out / "paper_gap.json").string()),
          .json = json};
}

}  // namespace biopsy::robot
