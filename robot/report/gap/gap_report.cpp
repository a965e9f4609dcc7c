#include "robot/report/gap/gap_report.hpp"

#include "robot/common/files/file.hpp"
#include "robot/report/gap/gap_html.hpp"
#include "robot/report/gap/gap_json.hpp"

namespace biopsy::report {

void save_gap(const GapFinding& finding, const std::filesystem::path& folder) {
  atomic_write(folder / "model.toml", finding.model_after);
  atomic_write(folder / "report.html", gap_html(finding));
  atomic_write(folder / "gap.json", gap_json(finding));  // last: who finds it finds the rest too
}

}  // namespace biopsy::report
