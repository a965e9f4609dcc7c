#include "planner/plan/fiducial_file.hpp"
#include "tests/verification/fuzz/target.hpp"

FUZZ(fiducials) {
  using namespace biopsy::fuzz;
  reads_or_refuses([&] { biopsy::planner::parse_fiducials(text_of(bytes), "fiducials.csv"); });
}
