#include "robot/common/logging/program.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "robot/common/config_error.hpp"

namespace biopsy::logging {
namespace {

void print_error(const std::string& what, const std::string& where, const std::string& remedy) {
  fmt::print(stderr, "error: {}\nwhere: {}\nto do: {}\n", what, where, remedy);
}

}  // namespace

int run_program(const std::string& name, const std::function<int()>& program) {
  try {
    return program();
  } catch (const ConfigError& error) {
    print_error(error.what_is_wrong, error.where, error.remedy);
  } catch (const std::exception& error) {
    print_error(error.what(), name, "report this with what led to it");
  }
  return 2;
}

}  // namespace biopsy::logging
