#include "tests/verification/fuzz/image.hpp"

FUZZ(nrrd) {
  biopsy::fuzz::read_image("image.nrrd", bytes);
}
