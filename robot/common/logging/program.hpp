// How every program ends: exit codes and error lines.
#pragma once

#include <functional>
#include <string>

namespace biopsy::logging {

// Runs `program` and returns its exit code. After a ConfigError or any other exception: 2, and the three
// lines "error:", "where:" and "to do:" on stderr. `name`: where other exceptions come from.
int run_program(const std::string& name, const std::function<int()>& program);

}  // namespace biopsy::logging
