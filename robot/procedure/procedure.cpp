#include "robot/procedure/procedure.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "robot/common/config_error.hpp"
#include "robot/common/typed_point.hpp"
#include "robot/procedure/prepared_case.hpp"
#include "robot/procedure/provenance.hpp"
#include "robot/report/procedure/report.hpp"

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

}  // namespace biopsy::robot
