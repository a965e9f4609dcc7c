// The gap workflow computes in metres; its findings are in mm.
#pragma once

namespace biopsy::sim::gap {

constexpr double kMm = 1e3;  // in a metre

}  // namespace biopsy::sim::gap
