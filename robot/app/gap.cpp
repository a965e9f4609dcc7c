#include "robot/app/commands.hpp"
#include "robot/messages/setup_error.hpp"

namespace biopsy::app {

int gap(const GapOptions& options) {
  throw SetupError("this build cannot search for a gap yet", options.dataset.string(),
                   "use a build that has the workflow");
}

}  // namespace biopsy::app
