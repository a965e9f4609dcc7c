// biopsy dry-run and biopsy plan.
#include "robot/cli/commands.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/progress.hpp"
#include "robot/procedure/prepared_case.hpp"
#include "robot/procedure/procedure.hpp"
#include "robot/procedure/rehearsal.hpp"

namespace biopsy::robot {

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
