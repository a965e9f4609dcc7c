// A made-up reproduction with a row of each kind: what the pages must be able to say.
#pragma once

#include "sim/paper/paper_figure.hpp"

namespace biopsy::report {

Reproduction example_reproduction();

// A loop that comes back another way than it went.
FigurePanel example_loop();

}  // namespace biopsy::report
