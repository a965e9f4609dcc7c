// A whole procedure against the simulated stage and scanner, on a virtual clock, from a sealed plan to a run record.
#pragma once

#include <filesystem>
#include <functional>

#include "robot/app/prepared_case.hpp"
#include "robot/report/run_record.hpp"

namespace biopsy::app {

// Told now and then what is going on: simulated seconds and a few words.
using Progress = std::function<void(double simulated_s, const std::string& what)>;

// The record of a plan (or its refusal) before anything moved.
report::RunRecord planned_record(const PreparedCase& prepared);

// Confirmation images are written to `folder`/images as DICOM and read back. `prepared` must hold a plan.
report::RunRecord rehearse(const PreparedCase& prepared, const std::filesystem::path& folder, const Progress& progress);

}  // namespace biopsy::app
