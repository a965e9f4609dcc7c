// The part of the command line that studies the stage rather than moves it.
#pragma once

#include <CLI/CLI.hpp>

#include "robot/cli/commands.hpp"

namespace biopsy::robot {

// What is typed; lives as long as the parsing.
struct StudyOptions {
  ReproduceOptions reproduced;
  CalibrateOptions calibrated;
  IdentifyOptions identified;
  DesignOptions designed;
  TuneOptions tuned;
  SafetyCaseOptions safety;
};

void add_study_commands(CLI::App& app, StudyOptions& options, int& code);

}  // namespace biopsy::robot
