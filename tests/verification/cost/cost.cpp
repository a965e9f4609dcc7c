// What one tick of the supervisor and one of the gate cost at most: instructions, counted by callgrind, and
// nanoseconds beside an empty call.
#include <unistd.h>

#include <algorithm>
#include <optional>

#include "tests/source_dir.hpp"
#include "tests/verification/cost/instructions.hpp"
#include "tests/verification/cost/measured.hpp"
#include "tests/verification/evidence_program.hpp"

namespace {

using namespace biopsy::fault_injection;
namespace fs = std::filesystem;

constexpr double kTick_ns = 1e6;
// One in a hundred of what a slow processor, an instruction a nanosecond, does in a tick.
constexpr std::int64_t kBudget = 10'000;

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
    for (const TickInput& tick : stream.ticks) {
      const auto begin = std::chrono::steady_clock::now();
      call(stream.facts, carried, tick);
      const auto end = std::chrono::steady_clock::now();
      each_ns.push_back(std::chrono::duration<double, std::nano>(end - begin).count());
    }
  }
  return sorted(std::move(each_ns));
}

void add(nlohmann::ordered_json& figures, const std::string& name, const std::vector<std::int64_t>& counts,
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

nlohmann::ordered_json measure(const std::vector<Stream>& streams, const Counts& counts) {
  using biopsy::safety::PlanFacts;
  const auto gate = [](const PlanFacts&, Carried& carried, const TickInput& tick) {
    measured_gate(carried, tick);
  };
  const auto no_gate = [](const PlanFacts&, Carried& carried, const TickInput& tick) {
    empty_gate(carried, tick);
  };
  nlohmann::ordered_json figures;
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

biopsy::EvidenceReport cost(bool quick) {
  fmt::print(stderr, "recording the inputs of supervisor and gate\n");
  const NominalModels models = read_nominal_models(biopsy::source_dir() / "sim/models");
  std::vector<Stream> streams = recorded_streams(models, quick ? 6 : 1'000);
  for (std::uint64_t seed = 1; seed <= (quick ? 2 : 20); ++seed)
    streams.push_back(random_stream(seed, 1'000));
  fmt::print(stderr, "counting instructions\n");
  const std::optional<Counts> counts = counted(streams, quick ? 500 : 100);
  if (!counts) throw biopsy::ConfigError("callgrind could not count", "valgrind", "install valgrind");
  biopsy::EvidenceReport report{.figures = measure(streams, *counts)};
  report.passed = report.figures["step_instructions_worst"] <= kBudget &&
                  report.figures["gate_instructions_worst"] <= kBudget;
  fmt::print("{}\n", report.figures.dump(2));
  return report;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 4 && std::string(argv[1]) == "--be-counted")
    return be_counted(argv[2], std::strtoull(argv[3], nullptr, 10));
  bool quick = false;
  CLI::App app{"What one tick of the supervisor and one of the gate cost at most"};
  app.add_flag("--quick", quick, "few classes of faults");
  return biopsy::evidence_program("cost", app, argc, argv, [&] { return cost(quick); });
}
