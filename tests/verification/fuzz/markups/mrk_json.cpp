#include "tests/verification/fuzz/markups/markups.hpp"

FUZZ(mrk_json) {
  biopsy::fuzz::read_points("points.mrk.json", bytes);
}
