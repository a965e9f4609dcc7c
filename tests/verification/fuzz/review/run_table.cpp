// run.csv of a finished run, for the review page: columns of one length, time that never runs back, spans in
// order.
#include "robot/console/review/run_table.hpp"

#include <cmath>

#include "tests/verification/fuzz/target.hpp"

FUZZ(run_table) {
  using namespace biopsy::fuzz;
  reads_or_refuses([&] {
    const biopsy::console::RunTable table = biopsy::console::parse_run_table(text_of(bytes), "run.csv");
    claim(table.columns.size() == table.values.size() && table.columns.front() == "time_s", "time is first");
    const std::vector<double>& time = table.values.front();
    for (const auto& column : table.values) {
      claim(column.size() == time.size() && !column.empty(), "columns of one length");
      for (const double value : column) claim(std::isfinite(value), "finite numbers only");
    }
    claim(std::is_sorted(time.begin(), time.end()), "time never runs back");
    claim(!table.spans.empty() && table.spans.front().from == time.front(), "a state from the first row on");
    claim(std::is_sorted(table.spans.begin(), table.spans.end(),
                         [](const auto& a, const auto& b) { return a.from < b.from; }),
          "states in order");
  });
}
