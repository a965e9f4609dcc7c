// biopsy dry-run and biopsy plan.
#include "robot/procedure/procedure.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "robot/procedure/prepared_case.hpp"
#include "robot/common/progress.hpp"
#include "robot/procedure/provenance.hpp"
#include "robot/procedure/rehearsal.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/typed_point.hpp"
#include "robot/common/config_error.hpp"
#include "robot/report/procedure/console_table.hpp"
#include "robot/report/procedure/report_folder.hpp"

namespace biopsy::robot {

namespace fs = std::filesystem;

Case case_of(const ProcedureOptions& options, Points points) {
  const bool by_image = !options.image.empty();
  if (by_image && !options.case_name.empty())
    throw ConfigError("both a case and --image", "command line",
                     "give a case file, or --image with --entry and --target");
  if (!by_image && (!options.entry.empty() || !options.target.empty() || !options.labels.empty()))
    throw ConfigError("--entry, --target or --labels without --image", "command line", "add --image PATH");
  Case given = by_image ? blank_case() : read_case(options.case_name.empty() ? "liver" : options.case_name);
  if (by_image) {
    const bool none = options.entry.empty() && options.target.empty();
    if ((options.entry.empty() || options.target.empty()) && !(none && points == Points::PickedLater))
      throw ConfigError("--image without --entry and --target", "command line",
                       "pick both points: --entry R,A,S --target R,A,S");
    given.image = options.image;
    given.title = (options.image / "").parent_path().filename().string();
    if (!none) {
      given.p_SE = typed_point("--entry", options.entry);
      given.p_ST = typed_point("--target", options.target);
    }
    given.labels = options.labels;
  }
  if (!options.series.empty()) given.series_uid = options.series;
  if (!options.fiducials.empty()) given.fiducials = options.fiducials;
  if (!options.model.empty()) given.rehearsal.model = options.model;
  if (options.seed) given.seed = *options.seed;
  return given;
}

void finish(report::RunRecord& record, const PreparedCase& prepared, const fs::path& out,
            std::chrono::steady_clock::time_point started) {
  record.provenance = provenance(prepared, record);
  record.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  report::save_report(record, out);
  fmt::print("{}", report::console_table(record, isatty(STDOUT_FILENO) == 1));
  fmt::print("\nreport: {}\n", (out / "report.html").string());
}

int dry_run(const ProcedureOptions& options) {
  const auto started = std::chrono::steady_clock::now();
  const Case given = case_of(options);
  claim_run_folder(options.out, files_of(given));
  ProgressLine line;
  line.show(-1.0, "reading the image and planning");
  const PreparedCase prepared = prepare(given, options.out);
  if (std::holds_alternative<PlanRefusal>(prepared.plan)) {
    report::RunRecord refused = planned_record(prepared);
    refused.simulated_s = 0.0;
    finish(refused, prepared, options.out, started);
    return 3;
  }
  report::RunRecord record = rehearse(
      prepared, options.out, [&line](double share, const std::string& what) { line.show(share, what); });
  finish(record, prepared, options.out, started);
  return record.outcome == report::Outcome::Completed ? 0 : 3;
}

int plan(const ProcedureOptions& options) {
  const auto started = std::chrono::steady_clock::now();
  const Case given = case_of(options);
  claim_run_folder(options.out, files_of(given));
  const PreparedCase prepared = prepare(given, options.out);
  report::RunRecord record = planned_record(prepared);
  record.simulated_s = 0.0;
  if (record.plan)
    record.outcome = report::Outcome::Completed;  // of what was asked; with no samples it says "planned"
  finish(record, prepared, options.out, started);
  return record.plan ? 0 : 3;
}

}  // namespace biopsy::robot
