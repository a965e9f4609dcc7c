#include "drivers/commissioning/record.hpp"
#include "tests/verification/fuzz/target.hpp"

FUZZ(commissioning_record) {
  using namespace biopsy;
  using namespace biopsy::fuzz;
  reads_or_refuses([&] {
    const std::string written = to_json(commissioning::from_json(text_of(bytes), "commissioning.json"));
    claim(to_json(commissioning::from_json(written, "written.json")) == written,
          "written anew it is the same");
  });
}
