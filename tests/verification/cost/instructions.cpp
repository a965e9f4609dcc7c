#include "tests/verification/cost/instructions.hpp"

#include <fmt/format.h>
#include <valgrind/callgrind.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>

#include "tests/verification/cost/measured.hpp"

namespace biopsy::fault_injection {
namespace {

constexpr std::size_t kAround = 6;  // ticks before and behind a change

// Which ticks change something: found by running them once, uncounted.
std::vector<bool> picked(const Stream& stream, std::size_t every) {
  std::vector<bool> pick(stream.ticks.size());
  Carried carried;
  safety::HazardSet before = 0;
  safety::EvidenceMemory memory;
  for (std::size_t k = 0; k < stream.ticks.size(); ++k) {
    const Mode mode = carried.state.mode;
    const safety::HazardSet hazards = safety::assess(stream.facts, memory, stream.ticks[k].seen).hazards();
    measured_step(stream.facts, carried, stream.ticks[k]);
    const bool changed = mode != carried.state.mode || hazards != before;
    before = hazards;
    if (k % every == 0) pick[k] = true;
    for (std::size_t i = k > kAround ? k - kAround : 0; changed && i < std::min(k + kAround, pick.size());
         ++i)
      pick[i] = true;
  }
  return pick;
}

// "totals: N" of each dump, in their order.
std::vector<std::int64_t> totals_of(const std::filesystem::path& file) {
  std::vector<std::int64_t> totals;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("totals: ")) totals.push_back(std::stoll(line.substr(8)));
  return totals;
}

std::vector<std::int64_t> count_one(const std::filesystem::path& program, const std::filesystem::path& file,
                                    std::size_t every, const char* function) {
  const std::filesystem::path out = file.string() + "." + function;
  const std::string command = fmt::format(
      "valgrind --tool=callgrind --toggle-collect={} --combine-dumps=yes --callgrind-out-file='{}' '{}' "
      "--be-counted '{}' {} > /dev/null 2>&1",
      function, out.string(), program.string(), file.string(), every);
  if (std::system(command.c_str()) != 0) return {};
  std::vector<std::int64_t> totals = totals_of(out);
  std::erase(totals, 0);  // dumps behind the calls of the other function
  return totals;
}

}  // namespace

std::optional<Counts> count_instructions(const std::filesystem::path& program,
                                         const std::filesystem::path& file, std::size_t every) {
  Counts counts;
  std::jthread beside([&] { counts.gate = count_one(program, file, every, "measured_gate"); });
  counts.step = count_one(program, file, every, "measured_step");
  beside.join();
  if (counts.step.empty() || counts.gate.empty()) return std::nullopt;
  return counts;
}

int be_counted(const std::filesystem::path& file, std::size_t every) {
  for (const Stream& stream : read_streams(file)) {
    const std::vector<bool> pick = picked(stream, every);
    CALLGRIND_ZERO_STATS;
    Carried carried;
    for (std::size_t k = 0; k < stream.ticks.size(); ++k) {
      if (pick[k]) CALLGRIND_ZERO_STATS;
      measured_step(stream.facts, carried, stream.ticks[k]);
      measured_gate(carried, stream.ticks[k]);
      if (pick[k]) CALLGRIND_DUMP_STATS;
    }
    CALLGRIND_ZERO_STATS;  // what was not picked is in no dump
  }
  return 0;
}

}  // namespace biopsy::fault_injection
