// Runs another program and takes what it says.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace biopsy {

struct ProcessResult {
  int exit_code = 127;  // 127: could not be started; 128 + n: ended by signal n
  std::string text;     // its standard output, and its errors where asked for
};

// The first word is the program, looked for in PATH if it has no slash. `input` is given to it. Blocks;
// `while_running` is called about ten times a second.
ProcessResult run_subprocess(
    const std::vector<std::string>& words, const std::string& input = {}, bool with_errors = false,
    const std::function<void()>& while_running = [] {});

}  // namespace biopsy
