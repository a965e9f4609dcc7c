#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "robot/cli/command_line.hpp"
#include "robot/common/config_error.hpp"

int main(int argc, char** argv) {
  try {
    return biopsy::robot::run_command_line(argc, argv);
  } catch (const biopsy::ConfigError& error) {
    fmt::print(stderr, "error: {}\nwhere: {}\nto do: {}\n", error.what_is_wrong, error.where, error.remedy);
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\nwhere: unexpected\nto do: report this with the command that was typed\n",
               error.what());
  }
  return 2;
}
