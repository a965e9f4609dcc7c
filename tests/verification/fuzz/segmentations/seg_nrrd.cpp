#include "tests/verification/fuzz/segmentations/labels.hpp"

FUZZ(seg_nrrd) {
  biopsy::fuzz::read_label_map("tissue.seg.nrrd", bytes);
}
