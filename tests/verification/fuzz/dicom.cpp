#include "tests/verification/fuzz/image.hpp"

FUZZ(dicom) {
  biopsy::fuzz::read_image("image.dcm", bytes);
}
