#include "robot/report/procedure/report_folder.hpp"

#include "robot/report/plot/png.hpp"
#include "robot/report/procedure/report_html.hpp"
#include "robot/report/procedure/report_json.hpp"
#include "robot/report/procedure/run_csv.hpp"

namespace biopsy::report {
namespace {

void save_if_any(const Picture& picture, const std::filesystem::path& path) {
  if (picture.width > 0 && picture.height > 0) save_png(picture, path);
}

}  // namespace

void save_report(const RunRecord& record, const std::filesystem::path& folder) {
  if (!record.samples.empty()) save_run_csv(record, folder / "run.csv");
  save_if_any(record.planning_slice, folder / "planning.png");
  for (std::size_t i = 0; i < record.stages.size(); ++i) {
    const std::string stage = "stage-" + std::to_string(i + 1);
    save_if_any(record.stages[i].before, folder / (stage + "-before.png"));
    save_if_any(record.stages[i].after, folder / (stage + "-after.png"));
  }
  save_report_html(record, folder / "report.html");
  save_report_json(record, folder / "report.json");  // last: who finds it finds the rest too
}

}  // namespace biopsy::report
