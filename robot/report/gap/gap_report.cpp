#include "robot/report/gap/gap_report.hpp"

#include "robot/report/gap/gap_html.hpp"
#include "robot/report/gap/gap_json.hpp"
#include "robot/common/files/whole_file.hpp"

namespace biopsy::report {

void save_gap(const GapFinding& finding, const std::filesystem::path& folder) {
  write_whole_file(folder / "model.toml", finding.model_after);
  write_whole_file(folder / "report.html", gap_html(finding));
  write_whole_file(folder / "gap.json", gap_json(finding));  // last: who finds it finds the rest too
}

}  // namespace biopsy::report
