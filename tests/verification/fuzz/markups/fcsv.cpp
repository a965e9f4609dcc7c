#include "tests/verification/fuzz/markups/markups.hpp"

FUZZ(fcsv) {
  biopsy::fuzz::read_points("points.fcsv", bytes);
}
