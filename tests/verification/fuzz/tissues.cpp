#include "sim/tissue/tissue.hpp"
#include "tests/verification/fuzz/target.hpp"

FUZZ(tissues) {
  using namespace biopsy::fuzz;
  const std::filesystem::path file = as_file("tissues.toml", bytes);
  reads_or_refuses([&] { biopsy::sim::read_tissues(file); });
}
