// A mistake in what was given to the program, found before anything moves. Thrown during set-up only, caught
// once in main, which prints the three lines and ends with exit code 2.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace biopsy {

struct ConfigError : std::runtime_error {
  ConfigError(std::string what, std::string place, std::string what_to_do)
      : std::runtime_error(place + ": " + what),
        what_is_wrong(std::move(what)),
        where(std::move(place)),
        remedy(std::move(what_to_do)) {}

  std::string what_is_wrong, where, remedy;
};

}  // namespace biopsy
