#include <cmath>
#include <sstream>

#include "planner/plan/fiducial_file.hpp"
#include "tests/verification/fuzz/target.hpp"

FUZZ(fiducials) {
  using namespace biopsy::fuzz;
  std::istringstream text(text_of(bytes));
  reads_or_refuses([&] { biopsy::planner::read_fiducials(text, "fiducials.csv"); });
}
