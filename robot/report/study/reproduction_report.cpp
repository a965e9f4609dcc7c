#include "robot/report/study/reproduction_report.hpp"

#include "robot/report/study/reproduction_html.hpp"
#include "robot/report/study/reproduction_json.hpp"
#include "robot/common/files/whole_file.hpp"

namespace biopsy::report {

void save_reproduction(const Reproduction& reproduction, const std::filesystem::path& folder) {
  write_whole_file(folder / "report.html", reproduction_html(reproduction));
  write_whole_file(folder / "reproduce.json",
                   reproduction_json(reproduction));  // last: who finds it finds the rest
}

}  // namespace biopsy::report
