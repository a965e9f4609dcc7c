#include "tests/verification/fuzz/image.hpp"

FUZZ(nifti) {
  biopsy::fuzz::read_image("image.nii", bytes);
}
