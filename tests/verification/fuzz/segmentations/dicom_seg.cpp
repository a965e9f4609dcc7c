#include "tests/verification/fuzz/segmentations/labels.hpp"

FUZZ(dicom_seg) {
  biopsy::fuzz::read_label_map("segmentation.dcm", bytes);
}
