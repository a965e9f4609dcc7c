// What changed from one text to another, line by line (longest common subsequence). The lines that are not
// Added are the first text, those that are not Removed the second.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace biopsy::report {

enum class DiffKind : std::uint8_t { Same, Removed, Added };

struct DiffLine {
  DiffKind kind = DiffKind::Same;
  std::string text;  // without its line end
  bool operator==(const DiffLine&) const = default;
};

std::vector<DiffLine> line_diff(std::string_view before, std::string_view after);

}  // namespace biopsy::report
