// What one tick of the supervisor and one of the gate cost at most: instructions, counted by callgrind, and
// nanoseconds beside an empty call. Exit 0 if the instructions stay within their share of a tick, 3 if not, 2
// for bad usage or without valgrind.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>
#include <string>

#include "tests/source_dir.hpp"
#include "tests/verification/cost/instructions.hpp"
#include "tests/verification/cost/measured.hpp"
#include "tests/verification/fault_injection/evidence_file.hpp"

namespace {

using namespace biopsy::proof;
namespace fs = std::filesystem;

constexpr double kTick_ns = 1e6;
// One in a hundred of what a slow processor, an instruction a nanosecond, does in a tick.
constexpr std::int64_t kBudget = 10'000;

struct Options {
  std::string json;
  bool quick = false;
};

std::optional<Options> parse(int count, char** words) {
  Options options;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (word == "--quick")
      options.quick = true;
    else if (word == "--json" && i + 1 < count)
      options.json = words[++i];
    else
      return std::nullopt;
  }
  return options;
}

struct Times {
  double best = 0.0, median = 0.0, p999 = 0.0, worst = 0.0;  // ns
};

Times sorted(std::vector<double> each_ns) {
  std::ranges::sort(each_ns);
  const auto at = [&](double share) {
    return each_ns[static_cast<std::size_t>(share * static_cast<double>(each_ns.size() - 1))];
  };
  return {each_ns.front(), at(0.5), at(0.999), each_ns.back()};
}

template <class Call>
Times time_each(const std::vector<Stream>& streams, Call&& call) {
  std::vector<double> each_ns;
  for (const Stream& stream : streams) {
    Carried carried;
    for (const Beat& beat : stream.beats) {
      const auto begin = std::chrono::steady_clock::now();
      call(stream.facts, carried, beat);
      const auto end = std::chrono::steady_clock::now();
      each_ns.push_back(std::chrono::duration<double, std::nano>(end - begin).count());
    }
  }
  return sorted(std::move(each_ns));
}

void add(nlohmann::json& figures, const std::string& name, const std::vector<std::int64_t>& counts,
         const Times& times, const Times& peer) {
  figures[name + "_instructions_worst"] = *std::ranges::max_element(counts);
  figures[name + "_instructions_median"] = [sorted = counts]() mutable {
    std::ranges::nth_element(sorted, sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2));
    return sorted[sorted.size() / 2];
  }();
  figures[name + "_calls_counted"] = counts.size();
  figures[name + "_ns_best"] = times.best;
  figures[name + "_ns_median"] = times.median;
  figures[name + "_ns_p999"] = times.p999;
  figures[name + "_ns_worst"] = times.worst;
  figures[name + "_ns_empty_call"] = peer.median;
  figures[name + "_times_empty_call"] = times.median / peer.median;
  figures[name + "_p999_share_of_tick"] = times.p999 / kTick_ns;
}

nlohmann::json measure(const std::vector<Stream>& streams, const Counts& counts) {
  using biopsy::safety::PlanFacts;
  const auto gate = [](const PlanFacts&, Carried& carried, const Beat& beat) {
    measured_gate(carried, beat);
  };
  const auto no_gate = [](const PlanFacts&, Carried& carried, const Beat& beat) {
    empty_gate(carried, beat);
  };
  nlohmann::json figures;
  add(figures, "step", counts.step, time_each(streams, measured_step), time_each(streams, empty_step));
  add(figures, "gate", counts.gate, time_each(streams, gate), time_each(streams, no_gate));
  figures["instructions_budget"] = kBudget;
  return figures;
}

std::optional<Counts> counted(const std::vector<Stream>& streams, std::size_t every) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("biopsy-cost-{}", ::getpid());
  fs::create_directories(folder);
  std::optional<Counts> counts;
  if (write_streams(folder / "streams", streams))
    counts = count_instructions(fs::read_symlink("/proc/self/exe"), folder / "streams", every);
  fs::remove_all(folder);
  return counts;
}

}  // namespace

int main(int count, char** words) {
  if (count == 4 && std::string(words[1]) == "--be-counted")
    return be_counted(words[2], std::strtoull(words[3], nullptr, 10));
  const std::optional<Options> options = parse(count, words);
  if (!options) {
    fmt::print(stderr, "cost [--json FILE] [--quick]\n");
    return 2;
  }
  fmt::print(stderr, "recording what supervisor and gate are given\n");
  const Workshop workshop = open_workshop(biopsy::source_dir() / "sim/models");
  std::vector<Stream> streams = recorded_streams(workshop, options->quick ? 6 : 1'000);
  for (std::uint64_t seed = 1; seed <= (options->quick ? 2 : 20); ++seed)
    streams.push_back(random_stream(seed, 1'000));
  fmt::print(stderr, "counting instructions\n");
  const std::optional<Counts> counts = counted(streams, options->quick ? 500 : 100);
  if (!counts) {
    fmt::print(stderr, "callgrind could not count; is valgrind installed?\n");
    return 2;
  }
  nlohmann::json out{{"tool", "cost"}, {"figures", measure(streams, *counts)}};
  const nlohmann::json& figures = out["figures"];
  const bool passed =
      figures["step_instructions_worst"] <= kBudget && figures["gate_instructions_worst"] <= kBudget;
  out["passed"] = passed;
  fmt::print("{}\n", out.dump(2));
  if (!options->json.empty() && !write_json(options->json, out)) return 2;
  return passed ? 0 : 3;
}
