// The honest test of the search for missing effects: every hidden case through it and through its peers, one
// line a case as it comes and one table at the end; and the time of the largest case against its bar.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <optional>

#include "sim/gap/find_gap.hpp"
#include "sim/plant/model_file.hpp"
#include "tests/bench/gap_peers.hpp"
#include "tests/kept_figures.hpp"
#include "tests/sim/gap/gap_score.hpp"
#include "tests/sim/gap/generator/hidden_data.hpp"

namespace biopsy::bench {
namespace {

using hidden::Answer;
using hidden::HiddenCase;

constexpr double kMostSeconds =
    60.0;  // docs/how-to/find-missing-effects.md: six runs of 40 s at 1 kHz on two cores
constexpr std::size_t kNaiveEvery = 6;      // it takes four times as long as the search
constexpr double kBarSeconds = 6.0 * 40.0;  // of recording in that case

struct Method {
  std::string name;
  std::function<Answer(const sim::Dataset&, const sim::PlantModel&)> answer;
  std::size_t every = 1;  // asked on every n-th case only
  hidden::Score score = {};
};

struct Options {
  bool quick = false, list = false, no_timing = false, say_steps = false;
  std::string only, group, peers = "some", keep;
  int seeds = 1, every = 1, runs = 0;
  double length = 1.0;
};

std::vector<HiddenCase> chosen_cases(const Options& options) {
  std::vector<HiddenCase> out;
  int index = 0;
  for (HiddenCase one : options.quick ? hidden::quick_cases() : hidden::hidden_cases()) {
    one.length *= options.length;
    if (options.runs > 0) one.runs = std::min(one.runs, options.runs);
    if (one.name.find(options.only) == std::string::npos) continue;
    if (!options.group.empty() && one.group != options.group) continue;
    if (index++ % options.every != 0) continue;
    out.push_back(one);
    for (int seed = 1; seed < options.seeds; ++seed)
      out.push_back(reseeded(one, static_cast<std::uint64_t>(seed)));
  }
  return out;
}

std::vector<Method> methods(const Options& options) {
  const bool say = options.say_steps;
  std::vector<Method> out;
  out.push_back({"find_gap", [say](const sim::Dataset& data, const sim::PlantModel& model) {
                   const auto begin = std::chrono::steady_clock::now();
                   const auto progress = [&](double, const std::string& doing) {
                     const std::chrono::duration<double> past = std::chrono::steady_clock::now() - begin;
                     if (say) fmt::print(stderr, "    {:6.2f} s  {}\n", past.count(), doing);
                   };
                   return hidden::answer_of(sim::gap::find_gap(data, model, {}, progress).finding);
                 }});
  if (options.peers == "none") return out;
  if (options.peers == "only") out.clear();
  out.push_back({"SINDy", regress_sparsely});
  out.push_back({"all parameters", fit_all_parameters});
  if (options.peers != "fast")
    out.push_back({"naive BIC", select_naively, options.peers == "all" ? 1 : kNaiveEvery});
  return out;
}

Answer timed(const Method& method, const sim::Dataset& data, const sim::PlantModel& model) {
  const auto begin = std::chrono::steady_clock::now();
  Answer answer = method.answer(data, model);
  answer.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return answer;
}

void print_line(const Method& method, const HiddenCase& hidden, const Answer& answer) {
  hidden::Score one;
  one.add(hidden, answer);
  std::string line = one.list();
  line.insert(line.find('\n'), fmt::format(", {:.1f} s", answer.seconds));
  fmt::print("{:15}{}", method.name, line);
  std::fflush(stdout);
}

sim::PlantModel model_of(const HiddenCase& hidden) {
  return sim::parse_model(hidden::baseline_model(hidden), "model.toml");
}

void run_cases(const std::vector<HiddenCase>& cases, std::vector<Method>& all) {
  std::size_t done = 0;
  for (const HiddenCase& hidden : cases) {
    fmt::print(stderr, "{} of {}: {}\n", ++done, cases.size(), hidden.name);
    const sim::Dataset data = make_hidden(hidden);
    const sim::PlantModel model = model_of(hidden);
    for (Method& method : all) {
      if (done % method.every != 0) continue;
      const Answer answer = timed(method, data, model);
      method.score.add(hidden, answer);
      print_line(method, hidden, answer);
    }
  }
}

void print_table(const std::vector<Method>& all, const std::string& keep) {
  std::vector<std::pair<std::string, hidden::Score>> columns;
  for (const Method& method : all) columns.emplace_back(method.name, method.score);
  fmt::print("\n{}\n", score_table(columns));
  if (!keep.empty())
    write_figures("gap", {keep, "explanation/gap-search.md", "g++ " __VERSION__, score_rows(columns)});
}

double recorded_seconds(const sim::Dataset& data) {
  double out = 0.0;
  for (const sim::RecordedRun& run : data.runs) out += run.period * static_cast<double>(run.time.size());
  return out;
}

// Two effects, so that every round of the search is held; six runs, as long in all as the bar says.
void print_time(const Method& method, const std::string& keep) {
  std::vector<std::vector<std::string>> rows;
  const auto all = hidden::hidden_cases();
  for (const char* name :
       {"coulomb_friction/strong", "coulomb_friction+charge_retention", "speckle_wander/strong"}) {
    HiddenCase largest = *std::ranges::find(all, std::string(name), &HiddenCase::name);
    largest.length = kBarSeconds / recorded_seconds(make_hidden(largest));
    const sim::Dataset data = make_hidden(largest);
    const Answer answer = timed(method, data, model_of(largest));
    fmt::print("{} runs, {:.0f} s at 1 kHz, whole library, {}: {:.1f} s (bar {:.0f} s){}\n", data.runs.size(),
               recorded_seconds(data), name, answer.seconds, kMostSeconds,
               answer.seconds < kMostSeconds ? "" : "  MISSED");
    print_line(method, largest, answer);
    rows.push_back({fmt::format("`{}`", name), fmt::format("{:.0f} s", answer.seconds)});
  }
  if (!keep.empty()) write_figures("gap-time", {keep, "explanation/gap-search.md", "g++ " __VERSION__, rows});
}

Options read_options(CLI::App& app, int argc, char** argv) {
  Options options;
  app.add_flag("--quick", options.quick, "twenty short cases instead of all");
  app.add_flag("--list", options.list, "names of the cases, and run nothing");
  app.add_flag("--no-timing", options.no_timing, "leave the largest case out");
  app.add_flag("--steps", options.say_steps, "what the search is doing, and when");
  app.add_option("--only", options.only, "cases whose name contains this");
  app.add_option("--group", options.group, "cases of one group, as in the second column");
  app.add_option("--every", options.every, "only every n-th case")->check(CLI::PositiveNumber);
  app.add_option("--length", options.length, "of each case, in its full lengths")
      ->check(CLI::Range(0.2, 1.0));
  app.add_option("--runs", options.runs, "of each case, at most")->check(CLI::PositiveNumber);
  app.add_option("--seeds", options.seeds, "draws of each case")->check(CLI::PositiveNumber);
  app.add_option("--keep", options.keep, "keep the table for the documentation, as that of this command");
  app.add_option("--peers", options.peers,
                 "none, fast (without naive selection), some (that on every sixth case), all, or only: "
                 "without the search")
      ->check(CLI::IsMember({"none", "fast", "some", "all", "only"}));
  app.parse(argc, argv);
  return options;
}

int run(const Options& options) {
  const auto cases = chosen_cases(options);
  if (options.list) {
    for (const HiddenCase& one : cases) fmt::print("{:11} {}\n", one.group, one.name);
    return 0;
  }
  auto all = methods(options);
  run_cases(cases, all);
  print_table(all, options.keep);
  if (!options.no_timing && options.peers != "only") print_time(all.front(), options.keep);
  return 0;
}

}  // namespace
}  // namespace biopsy::bench

int main(int argc, char** argv) {
  CLI::App app("hidden effects: the search and its peers");
  try {
    return biopsy::bench::run(biopsy::bench::read_options(app, argc, argv));
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  }
}
