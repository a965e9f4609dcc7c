#include "tests/verification/fuzz/image.hpp"

FUZZ(metaimage) {
  biopsy::fuzz::read_image("image.mha", bytes);
}
