// report.json of a finished run, for the review page: what comes out can be shown.
#include "robot/console/review/run_report.hpp"

#include <cmath>

#include "tests/verification/fuzz/target.hpp"

FUZZ(run_report) {
  using namespace biopsy::fuzz;
  reads_or_refuses([&] {
    const biopsy::console::RunReport report =
        biopsy::console::parse_run_report(text_of(bytes), "report.json");
    claim(report.outcome == "completed" || report.outcome == "stopped", "what was refused is not shown");
    for (const auto& hazard : report.hazards)
      claim(hazard.at >= 0.0 && hazard.at <= 1e6, "a time in the run");
    for (const auto& image : report.images) {
      claim(image.at >= 0.0 && image.at <= 1e6 && image.step >= 1, "an image of a step, in the run");
      claim(std::isfinite(image.found) && image.sigma >= 0.0, "a depth that can be shown");
    }
    for (const std::string* text : {&report.title, &report.verdict})
      for (const char letter : *text)
        claim(static_cast<unsigned char>(letter) >= 0x20, "text without control characters");
  });
}
