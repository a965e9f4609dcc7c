// A whole procedure against the simulated stage and scanner, on a virtual clock, from a sealed plan to a run
// record.
#pragma once

#include <filesystem>
#include <functional>

#include "robot/app/prepared_case.hpp"
#include "robot/report/run_record.hpp"

namespace biopsy::app {

// Told now and then how much of the way is done, in [0, 1], and what is going on.
using Progress = std::function<void(double share, const std::string& what)>;

// The record of a plan (or its refusal) before anything moved.
report::RunRecord planned_record(const PreparedCase& prepared);

// Confirmation images are written to `folder`/images as DICOM and read back. `prepared` must hold a plan.
report::RunRecord rehearse(const PreparedCase& prepared, const std::filesystem::path& folder,
                           const Progress& progress);

}  // namespace biopsy::app
