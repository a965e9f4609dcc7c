#include "robot/live/live_settings.hpp"

#include "tests/verification/fuzz/target.hpp"

FUZZ(live_settings) {
  using namespace biopsy;
  using namespace biopsy::fuzz;
  reads_or_refuses([&] {
    const std::string written = live::to_json(live::parse_settings(text_of(bytes), "live.json"));
    claim(live::to_json(live::parse_settings(written, "written.json")) == written,
          "written anew it is the same");
  });
}
