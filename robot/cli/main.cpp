#include "robot/cli/command_line.hpp"
#include "robot/cli/version.hpp"
#include "robot/common/logging/program.hpp"

int main(int argc, char** argv) {
  using namespace biopsy;
  return logging::run_program("biopsy",
                              [&] { return robot::run_command_line(argc, argv, robot::version_text()); });
}
