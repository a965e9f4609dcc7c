// The folder a run writes to.
#pragma once

#include <filesystem>

namespace biopsy::app {

// Makes the folder ready for a run: creates it, or clears what an earlier run left in it. Only folders this
// function marked before are cleared; in a folder that is not empty and not ours nothing is touched. Throws
// SetupError.
void claim_run_folder(const std::filesystem::path& folder);

}  // namespace biopsy::app
