#include "robot/cli/command_line.hpp"
#include "robot/common/logging/program.hpp"

int main(int argc, char** argv) {
  return biopsy::logging::run_program("biopsy", [&] { return biopsy::robot::run_command_line(argc, argv); });
}
