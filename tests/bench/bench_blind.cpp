// The blind challenge: sealed cases of blind/, written as folders, read as a laboratory's, answered by the
// search and by its peers. One line a case, one table at the end.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>

#include "sim/gap/find_gap.hpp"
#include "sim/plant/model_file.hpp"
#include "tests/bench/blind/blind_cases.hpp"
#include "tests/bench/gap_peers.hpp"
#include "tests/kept_figures.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/sim/gap/gap_score.hpp"

namespace biopsy::bench {
namespace {

using blind::BlindCase;
using blind::Kind;
using hidden::Answer;

constexpr double kWellClosed = 0.8, kHalfClosed = 0.5;

struct Options {
  std::string only, kind, write, peers = "none", keep;
  int every = 1, from = 0;
  std::uint64_t seed = 1;
};

// The scores know cases by what is expected of them.
hidden::HiddenCase as_scored(const BlindCase& one) {
  hidden::HiddenCase out;
  out.name = one.name;
  out.group = one.mass_rig ? "mass" : "stage";
  switch (one.kind) {
    case Kind::Single:
      out.kind = hidden::HiddenKind::Single;
      break;
    case Kind::Pair:
      out.kind = hidden::HiddenKind::Pair;
      break;
    case Kind::Nothing:
      out.kind = hidden::HiddenKind::Nothing;
      break;
    case Kind::Outside:
      out.kind = hidden::HiddenKind::Outside;
      break;
  }
  for (const std::string& name : one.effects) out.terms.push_back({name, 0.0});
  return out;
}

std::string to_string(Kind kind) {
  switch (kind) {
    case Kind::Single:
      return "single";
    case Kind::Pair:
      return "pair";
    case Kind::Nothing:
      return "nothing";
    case Kind::Outside:
      break;
  }
  return "outside";
}

struct Method {
  std::string name;
  Answer (*answer)(const sim::Dataset&, const sim::PlantModel&);
  hidden::Score score = {};
};

// What a proposed term is worth, and names with less than half of the gap closed.
struct Proposals {
  int asked = 0, proposed = 0, closed = 0, right = 0, empty_names = 0;

  std::string add(const BlindCase& one, const GapFinding& finding) {
    if (finding.verdict == GapVerdict::Effect && finding.gap_closed < kHalfClosed) ++empty_names;
    if (one.kind != Kind::Outside || finding.verdict != GapVerdict::Unexplained) return {};
    ++asked;
    if (!finding.proposed) return "; nothing proposed";
    ++proposed;
    const ProposedTerm& term = *finding.proposed;
    const auto strongest = std::ranges::max_element(term.coefficients, {}, &TermCoefficient::share);
    const bool well = term.gap_closed >= kWellClosed;
    const bool same = std::ranges::any_of(one.variables, [&](char letter) {
      return std::ranges::any_of(term.coefficients, [&](const TermCoefficient& part) {
        return part.share > 0.3 * strongest->share && part.product.find(letter) != std::string::npos;
      });
    });
    if (well) ++closed;
    if (well && same) ++right;
    return fmt::format("; proposed {} closes {:.3f}{}", term.expression, term.gap_closed,
                       same ? "" : ", of another variable");
  }

  std::vector<std::vector<std::string>> rows() const {
    return {{"outside the library and unexplained, with a term", fmt::format("{} of {}", proposed, asked)},
            {"that closes 80 % of the held-out gap (>= 70 %)", fmt::format("{} of {}", closed, asked)},
            {"and is of the right variable (>= 80 %)", fmt::format("{} of {}", right, closed)}};
  }
};

Answer timed(const std::function<Answer()>& answer) {
  const auto begin = std::chrono::steady_clock::now();
  Answer out = answer();
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  out.rejected.resize(std::min<std::size_t>(out.rejected.size(), 3));
  for (hidden::AnsweredEffect& effect : out.effects) effect.parameters.clear();  // other parametrisation
  return out;
}

void print_line(const std::string& method, const BlindCase& one, const Answer& answer, double size,
                const std::string& more) {
  hidden::Score line;
  line.add(as_scored(one), answer);
  std::string text = line.list();
  text.insert(text.find('\n'), fmt::format(", {:.0f} noises, {:.1f} s{}", size, answer.seconds, more));
  fmt::print("{:15}{}", method, text);
  std::fflush(stdout);
}

int run(const Options& options) {
  std::vector<Method> peers;
  if (options.peers != "none") {
    peers.push_back({"SINDy", regress_sparsely});
    peers.push_back({"all parameters", fit_all_parameters});
    if (options.peers == "all") peers.push_back({"naive BIC", select_naively});
  }
  const ScratchFolder scratch;
  hidden::Score ours;
  Proposals proposals;
  int index = -1;
  for (const BlindCase& one : blind::blind_cases(options.seed)) {
    if (one.name.find(options.only) == std::string::npos) continue;
    if (!options.kind.empty() && to_string(one.kind) != options.kind) continue;
    if (++index % options.every != options.from) continue;
    const auto folder = options.write.empty()
                            ? scratch.path() / std::to_string(index)
                            : std::filesystem::path(options.write) / fmt::format("case-{:03}", index);
    const double size = write_case(one, folder);
    if (!options.write.empty()) {
      fmt::print("case-{:03},{},{},{:.1f}\n", index, one.name, one.variables, size);
      continue;
    }
    const sim::PlantModel model = sim::read_model(folder / "model.toml");
    const sim::Dataset data = sim::read_dataset(folder, model.baseline.drive);
    std::string more;
    const Answer answer = timed([&] {
      const GapFinding finding = sim::gap::find_gap(data, model, {}).finding;
      more = proposals.add(one, finding);
      return hidden::answer_of(finding);
    });
    ours.add(as_scored(one), answer);
    print_line("find_gap", one, answer, size, more);
    for (Method& peer : peers) {
      const Answer other = timed([&] { return peer.answer(data, model); });
      peer.score.add(as_scored(one), other);
      print_line(peer.name, one, other, size, "");
    }
    std::filesystem::remove_all(folder);
  }
  if (!options.write.empty()) return 0;
  std::vector<std::pair<std::string, hidden::Score>> columns{{"find_gap", ours}};
  for (const Method& peer : peers) columns.emplace_back(peer.name, peer.score);
  fmt::print("\n{}\n", score_table(columns));
  const auto keep = [&](const char* name, const std::vector<std::vector<std::string>>& rows) {
    if (!options.keep.empty())
      write_figures(name, {options.keep, "explanation/gap-search.md", "g++ " __VERSION__, rows});
  };
  if (options.kind.empty()) keep(options.peers == "none" ? "blind-whole" : "blind", score_rows(columns));
  if (options.kind == "outside") keep("blind-terms", proposals.rows());
  fmt::print(
      "Named with less than half of the gap closed: {}. Outside the library and unexplained: {}; a term "
      "proposed: "
      "{}, closes 80 % of the held-out gap: {}, of the right variable: {}.\n",
      proposals.empty_names, proposals.asked, proposals.proposed, proposals.closed, proposals.right);
  return 0;
}

}  // namespace
}  // namespace biopsy::bench

int main(int argc, char** argv) {
  CLI::App app("hidden effects of rigs that nobody here tuned the search on");
  biopsy::bench::Options options;
  app.add_option("--only", options.only, "cases whose sealed name contains this");
  app.add_option("--kind", options.kind, "cases of one kind")
      ->check(CLI::IsMember({"single", "pair", "nothing", "outside"}));
  app.add_option("--every", options.every, "only every n-th case")->check(CLI::PositiveNumber);
  app.add_option("--from", options.from, "which of each n")->check(CLI::NonNegativeNumber);
  app.add_option("--seed", options.seed, "of all that is drawn");
  app.add_option("--write", options.write, "only write the cases into this folder, and print the answers");
  app.add_option("--keep", options.keep, "keep the table for the documentation, as that of this command");
  app.add_option("--peers", options.peers,
                 "none, fast (sparse regression, all parameters) or all (naive BIC too)")
      ->check(CLI::IsMember({"none", "fast", "all"}));
  try {
    app.parse(argc, argv);
    return biopsy::bench::run(options);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  }
}
