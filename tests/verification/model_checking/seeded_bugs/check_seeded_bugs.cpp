#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <mutex>

#include "robot/common/in_parallel.hpp"
#include "tests/verification/model_checking/checks.hpp"
#include "tests/verification/model_checking/seeded_bugs/find_violation.hpp"

namespace biopsy::model_checking {
namespace {

// What an unchanged copy breaks, by part: nothing, if the shipped code is clean.
std::array<Violations, 2> search_unchanged_copy(const MutantBuild& mutant_build) {
  const SeededSubject subject(mutant_build, nullptr);
  return {find_violation(subject.get(), Part::Supervisor, {}), find_violation(subject.get(), Part::Gate, {})};
}

void add_row(EvidenceReport& report, const SeededBug& bug, const Violations& caught) {
  report.tables["bugs"].push_back(
      {{"id", bug.id},
       {"sentence", bug.sentence},
       {"part", bug.part == Part::Gate ? "gate" : "supervisor"},
       {"file", fmt::format("safety/{}", bug.file)},
       {"caught_by", fmt::format("{}", fmt::join(caught.claims, ", "))},
       {"counterexample", caught.counterexamples.empty() ? "" : caught.counterexamples.front()}});
}

}  // namespace

void check_bugs(EvidenceReport& report, const MutantBuild& mutant_build) {
  const Stopwatch time;
  const std::array<Violations, 2> unchanged = search_unchanged_copy(mutant_build);
  const std::span<const SeededBug> bugs = seeded_bugs();
  std::vector<Violations> caught(bugs.size());
  std::mutex mutex;
  in_parallel(bugs.size(), [&](std::size_t i) {
    const SeededSubject subject(mutant_build, &bugs[i]);
    caught[i] =
        find_violation(subject.get(), bugs[i].part, unchanged[static_cast<std::size_t>(bugs[i].part)].claims);
    const std::lock_guard lock(mutex);
    fmt::print(stderr, "seeded bug {}: breaks {}\n", bugs[i].id,
               caught[i].claims.empty() ? "nothing that is looked at"
                                        : fmt::format("{}", fmt::join(caught[i].claims, ", ")));
  });
  for (std::size_t i = 0; i < bugs.size(); ++i) add_row(report, bugs[i], caught[i]);
  const auto found = std::ranges::count_if(caught, [](const Violations& c) { return !c.claims.empty(); });
  const std::size_t broken_unchanged = unchanged[0].claims.size() + unchanged[1].claims.size();
  report.figures["bugs_total"] = bugs.size();
  report.figures["bugs_caught"] = found;
  report.figures["bugs_missed"] = bugs.size() - found;
  report.figures["unchanged_copy_broken_claims"] = broken_unchanged;
  report.figures["bugs_seconds"] = time.seconds();
  report.require(found == static_cast<std::ptrdiff_t>(bugs.size()) && broken_unchanged == 0);
}

}  // namespace biopsy::model_checking
