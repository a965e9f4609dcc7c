#include <fmt/format.h>

#include "robot/cli/command.hpp"

namespace biopsy::robot {

// Each in robot/cli/commands.
Command dry_run_command(), campaign_command(), plan_command(), check_command(), image_command(),
    calibrate_tip_command();
Command up_command(), confirm_command(), log_group(), log_show_command(), log_verify_command(),
    log_export_command();
Command keys_group(), keys_init_command(), keys_check_command(), commission_command();
Command characterise_command(), simulate_command(), effects_command(), gap_command();
Command reproduce_command(), calibrate_command(), identify_command(), design_command(), tune_command();
Command safety_case_command(), help_command(), completion_group(), completion_bash_command();

const std::vector<Command>& registry() {
  static const std::vector<Command> kCommands{dry_run_command(),
                                              campaign_command(),
                                              plan_command(),
                                              check_command(),
                                              calibrate_tip_command(),
                                              image_command(),
                                              simulate_command(),
                                              effects_command(),
                                              gap_command(),
                                              characterise_command(),
                                              up_command(),
                                              confirm_command(),
                                              keys_group(),
                                              keys_init_command(),
                                              keys_check_command(),
                                              log_group(),
                                              log_show_command(),
                                              log_verify_command(),
                                              log_export_command(),
                                              commission_command(),
                                              reproduce_command(),
                                              calibrate_command(),
                                              identify_command(),
                                              design_command(),
                                              tune_command(),
                                              safety_case_command(),
                                              help_command(),
                                              completion_group(),
                                              completion_bash_command()};
  return kCommands;
}

std::vector<std::string> clearable_outputs() {
  std::vector<std::string> names;
  for (const Command& command : registry())
    if (command.replaces_earlier_run)
      for (const OutputFile& output : command.outputs)
        if (!output.kept) names.push_back(output.name);
  return names;
}

void Context::say(const std::string& line) const {
  fmt::print(json ? stderr : stdout, "{}\n", line);
  std::fflush(json ? stderr : stdout);
}

}  // namespace biopsy::robot
