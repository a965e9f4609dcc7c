// Answers of the gap workflow are in mm; inside it is metres.
#pragma once

namespace biopsy::sim::gap {

constexpr double kMm = 1e3;  // in a metre

}  // namespace biopsy::sim::gap
