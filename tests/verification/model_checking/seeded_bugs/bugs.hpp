// Seeded design bugs: slips a designer could make. Each is one exact text in one file of safety/ and what
// stands there instead; only a copy is changed, built for this alone. The explorer must find a violation in
// each.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace biopsy::model_checking {

enum class Part : std::uint8_t { Supervisor, Gate };

struct SeededBug {
  std::string_view id, sentence;
  Part part;
  std::string_view file;  // under safety/
  std::string_view text, replacement;
};

std::span<const SeededBug> seeded_bugs();

// The text with the bug in it. Throws ConfigError where `bug.text` is not there exactly once.
std::string with_bug(const SeededBug& bug, const std::string& source);

}  // namespace biopsy::model_checking
