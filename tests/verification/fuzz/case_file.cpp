#include "robot/procedure/case/case.hpp"
#include "tests/verification/fuzz/target.hpp"

FUZZ(case_file) {
  using namespace biopsy;
  using namespace biopsy::fuzz;
  const std::filesystem::path file = as_file("case.toml", bytes);
  reads_or_refuses([&] {
    const robot::Case read = robot::read_case(file.string());
    claim(read.depth || (read.p_SE && read.p_ST), "a case has a target");
    claim(read.weight.value >= 0.0 && read.pace.speed.value > 0.0, "numbers within their ranges");
  });
}
