#include "robot/report/study/reproduction_report.hpp"

#include "robot/common/files/file.hpp"
#include "robot/report/study/reproduction_html.hpp"
#include "robot/report/study/reproduction_json.hpp"

namespace biopsy::report {

void save_reproduction(const Reproduction& reproduction, const std::filesystem::path& folder) {
  atomic_write(folder / "report.html", reproduction_html(reproduction));
  atomic_write(folder / "reproduce.json",
               reproduction_json(reproduction));  // last: who finds it finds the rest
}

}  // namespace biopsy::report
