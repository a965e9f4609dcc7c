#include "robot/common/files/file.hpp"
#include "robot/report/plot/plane_overlay.hpp"
#include "robot/report/plot/png.hpp"
#include "robot/report/procedure/report.hpp"

namespace biopsy::report {
namespace {

void save_if_any(const Picture& picture, const std::filesystem::path& path) {
  if (picture.width > 0 && picture.height > 0) save_png(picture, path);
}

}  // namespace

void save_report(const RunRecord& record, const std::filesystem::path& folder) {
  if (!record.samples.empty()) atomic_write(folder / "run.csv", run_csv(record));
  save_if_any(record.planning_slice, folder / "planning.png");
  for (const BodyPlane& plane : record.planes) save_if_any(plane.picture, folder / (plane.name + ".png"));
  for (std::size_t i = 0; i < record.steps.size(); ++i) {
    const std::string step = "stage-" + std::to_string(i + 1);
    save_if_any(record.steps[i].before, folder / (step + "-before.png"));
    save_if_any(record.steps[i].after, folder / (step + "-after.png"));
    save_if_any(difference_of(record.steps[i].before, record.steps[i].after),
                folder / (step + "-difference.png"));
  }
  atomic_write(folder / "report.html", report_html(record));
  atomic_write(folder / "report.json",
               report_json(record));  // last: its presence means that the rest is there
}

}  // namespace biopsy::report
