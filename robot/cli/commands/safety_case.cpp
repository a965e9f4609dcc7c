// biopsy safety-case: gathers the evidence of this build and writes the case.
#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <iterator>

#include "robot/cli/command.hpp"
#include "robot/cli/safety_case/safety_case_files.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/code_identity.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/data_folder.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/in_parallel.hpp"
#include "robot/common/progress.hpp"
#include "robot/common/subprocess.hpp"
#include "robot/report/safety_case/case_page.hpp"
#include "robot/report/safety_case/finding_json.hpp"
#include "robot/report/safety_case/gaps.hpp"
#include "robot/report/safety_case/risk_document.hpp"

namespace biopsy::robot {
namespace safety_case_cli {

namespace fs = std::filesystem;
using safety_case::Build;
using safety_case::Finding;
using safety_case::Source;
using Clock = std::chrono::steady_clock;

struct Options {
  fs::path out;
  fs::path collect;       // evidence gathered earlier; empty: run everything
  bool quick = false;     // the short subset
  bool markdown = false;  // docs/reference/risk-management.md
};

void declare(CLI::App& app, Options& options) {
  app.add_flag("--quick", options.quick, "the short subset, two minutes; releases nothing");
  add(app, "--collect FOLDER", options.collect, "evidence folder of an earlier case; nothing is run");
  CLI::Option* out = add_out(app, options.out, "the case");
  app.add_flag("--markdown", options.markdown,
               "print the page [risk management file](risk-management.md); nothing is run")
      ->excludes(out);
}

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::string filled(std::string word, const fs::path& tests, const fs::path& out) {
  for (const auto& [hole, value] :
       {std::pair<std::string, std::string>{"{tests}", tests}, {"{source}", source_folder()}, {"{out}", out}})
    for (std::size_t at = word.find(hole); at != std::string::npos; at = word.find(hole))
      word.replace(at, hole.size(), value);
  return word;
}

// Where the programs of the tests lie, beside this one.
fs::path tests_folder() {
  return fs::read_symlink("/proc/self/exe").parent_path() / "tests";
}

// Before anything runs: half a case takes as long and says nothing.
void expect_programs(const safety_case::SafetyCase& safety_case, bool quick) {
  std::size_t asked = 0, missing = 0;
  for (const Source& source : safety_case.sources) {
    if (quick && !source.in_quick) continue;
    ++asked;
    if (!fs::exists(filled(source.command.front(), tests_folder(), {}))) ++missing;
  }
  if (missing > 0)
    throw ConfigError(fmt::format("{} of {} programs of evidence are not built", missing, asked),
                      tests_folder(),
                      fmt::format("run ./dev safety-case{}, which builds them", quick ? " --quick" : ""));
}

// Runs one source; what it printed is kept beside its figures. Nothing where it could not be run or wrote no
// figures: then the case has a gap.
std::optional<Finding> run_source(const Source& source, const Build& build, const fs::path& folder,
                                  ProgressLine& line, double share) {
  const fs::path raw = folder / (source.id + ".raw.json");
  std::vector<std::string> words;
  for (const std::string& word : source.command) words.push_back(filled(word, tests_folder(), raw));
  const std::vector<std::string>& more = build.quick ? source.quick : source.full;
  words.insert(words.end(), more.begin(), more.end());
  Finding finding;
  finding.source = source.id;
  finding.date = utc_now();
  finding.commit = build.commit;
  finding.code = build.code;
  finding.quick = build.quick && source.quick != source.full;
  const Clock::time_point start = Clock::now();
  const ProcessResult result = run_subprocess(words, {}, true, [&] {
    line.show(share, fmt::format("{}, {:.0f} s", source.title, seconds_since(start)));
  });
  finding.seconds = seconds_since(start);
  atomic_write(folder / (source.id + ".txt"), result.text);
  if (!fs::exists(raw)) return std::nullopt;
  const std::string json = read_file_if_present(raw);
  source.kind == safety_case::SourceKind::Tests ? read_tests(json, raw.string(), finding)
                                                : read_proof(json, raw.string(), finding);
  finding.passed = finding.passed && result.exit_code == 0;
  fs::remove(raw);
  return finding;
}

// Those that measure real time one by one, then the others side by side; findings in the order of the
// sources.
std::vector<Finding> gather(const safety_case::SafetyCase& safety_case, const Build& build,
                            const fs::path& folder) {
  const std::vector<Source>& sources = safety_case.sources;
  std::vector<std::optional<Finding>> found(sources.size());
  ProgressLine line;
  std::atomic<int> done = 0;
  const auto run = [&](std::size_t i) {
    const double share = static_cast<double>(done) / static_cast<double>(sources.size());
    found[i] = run_source(sources[i], build, folder, line, share);
    if (found[i]) atomic_write(folder / (sources[i].id + ".json"), to_json(*found[i]));
    ++done;
  };
  std::vector<std::size_t> beside;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (build.quick && !sources[i].in_quick) continue;
    if (sources[i].side_by_side)
      beside.push_back(i);
    else
      run(i);
  }
  in_parallel(beside.size(), [&](std::size_t i) { run(beside[i]); });
  std::vector<Finding> findings;
  for (std::optional<Finding>& finding : found)
    if (finding) findings.push_back(std::move(*finding));
  return findings;
}

std::vector<Finding> collect(const safety_case::SafetyCase& safety_case, const fs::path& folder) {
  if (!fs::is_directory(folder))
    throw ConfigError("is no folder of evidence", folder.string(),
                      "give the evidence folder of an earlier case");
  std::vector<Finding> findings;
  for (const Source& source : safety_case.sources)
    if (const fs::path file = folder / (source.id + ".json"); fs::exists(file))
      findings.push_back(safety_case::finding_from_json(read_file_if_present(file), file.string()));
  return findings;
}

// The argument as SVG; empty where graphviz is missing, which is a gap.
std::string drawn(const std::string& dot, std::vector<safety_case::Gap>& gaps) {
  const ProcessResult svg = run_subprocess({"dot", "-Tsvg"}, dot);
  if (svg.exit_code == 0 && svg.text.find("<svg") != std::string::npos)
    return svg.text.substr(svg.text.find("<svg"));
  gaps.push_back({"argument", "graphviz (dot) did not draw it: install graphviz"});
  return {};
}

Result page(const safety_case::SafetyCase& safety_case, const Options& options, const Context& context) {
  if (context.json || options.quick || !options.collect.empty())
    throw ConfigError("--markdown beside an option that it has no use for", "biopsy safety-case",
                      "give --markdown alone");
  return {.text = risk_markdown(safety_case)};
}

Result run(const Options& options, const Context& context) {
  const Clock::time_point start = Clock::now();
  const safety_case::SafetyCase safety_case = read_safety_case(data_folder() / "safety/case");
  if (options.markdown) return page(safety_case, options, context);
  if (options.out.empty())
    throw ConfigError("no folder for the case", "biopsy safety-case", "add --out FOLDER, or --markdown");
  Build build{.date = utc_now(),
              .commit = commit_of(source_folder()),
              .code = code_fingerprint(source_folder()),
              .version = BIOPSY_VERSION,
              .quick = options.quick};
  std::vector<Finding> findings;
  if (options.collect.empty())
    expect_programs(safety_case, options.quick);
  else
    findings = collect(safety_case, options.collect);
  claim_run_folder(options.out, {options.collect}, context.clearable);
  const fs::path folder = options.out / "evidence";
  fs::create_directories(folder);
  if (options.collect.empty()) findings = gather(safety_case, build, folder);
  build.seconds = seconds_since(start);

  std::vector<safety_case::Gap> gaps = gaps_in_argument(safety_case);
  for (const safety_case::Gap& gap : gaps_in_evidence(safety_case, findings, build)) gaps.push_back(gap);
  const std::string dot = argument_dot(safety_case, findings, gaps);
  const std::string svg = drawn(dot, gaps);
  const std::string json = case_json(safety_case, findings, gaps, build);
  atomic_write(options.out / "argument.dot", dot);
  if (!svg.empty()) atomic_write(options.out / "argument.svg", svg);
  atomic_write(options.out / "report.html", case_html(safety_case, findings, gaps, build, svg));
  atomic_write(options.out / "risk-management.md", risk_markdown(safety_case));
  atomic_write(options.out / "safety-case.json", json);

  std::string text = case_sentence(safety_case, findings, gaps, build) + "\n";
  for (const safety_case::Gap& gap : gaps) text += fmt::format("  {}: {}\n", gap.where, gap.what);
  text += fmt::format("\nreport: {}\n", (options.out / "report.html").string());
  return {.exit_code = gaps.empty() ? 0 : 3, .text = text, .json = json};
}

}  // namespace safety_case_cli

Command safety_case_command() {
  using namespace safety_case_cli;
  return {.name = "safety-case",
          .summary = "hazards, requirements, argument and evidence of this build",
          .description =
              "Runs every test and proof that the [safety case](../explanation/verification.md) names (about "
              "a quarter of an hour) and prints the [risk management file](risk-management.md). Fails on a "
              "requirement without fresh evidence, a test that names an unknown "
              "requirement, a broken link, a figure outside its acceptance criterion. `./dev "
              "safety-case` builds what it needs and runs it.",
          .examples = {"biopsy safety-case --markdown"},
          .long_examples = {"biopsy safety-case --out out/safety-case",
                            "biopsy safety-case --collect out/safety-case/evidence --out out/again"},
          .exit_codes = "0 where it has no gap, 3 where the case does not hold, 2 for unusable input",
          .outputs = {{"report.html", "the case for people"},
                      {"risk-management.md", "risks, software items, SOUP, threats and use scenarios"},
                      {"safety-case.json", "the case for programs"},
                      {"argument.svg", "the argument, drawn"},
                      {"argument.dot", "its source"},
                      {"evidence", "what each source printed and found"}},
          .replaces_earlier_run = true,
          .json = "the content of `safety-case.json`",
          .declare = with_options(declare, run)};
}

}  // namespace biopsy::robot
