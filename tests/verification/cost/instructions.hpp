// Exact instruction counts of single calls, by callgrind.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "tests/verification/cost/stream.hpp"

namespace biopsy::fault_injection {

struct Counts {
  std::vector<std::int64_t> step, gate;  // of every call that was counted
};

// Runs `program` (this one) under callgrind over the streams in `file`. Nothing where valgrind is not there
// or failed.
std::optional<Counts> count_instructions(const std::filesystem::path& program,
                                         const std::filesystem::path& file, std::size_t every);

// The other side, inside callgrind: all ticks, counted one by one around each change of mode or hazards and
// at every `every`th besides.
int be_counted(const std::filesystem::path& file, std::size_t every);

}  // namespace biopsy::fault_injection
