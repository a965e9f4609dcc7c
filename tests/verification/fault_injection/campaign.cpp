#include "tests/verification/fault_injection/campaign.hpp"

#include <algorithm>
#include <atomic>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <optional>

#include "robot/common/in_parallel.hpp"
#include "safety/types/limits.hpp"
#include "tests/safety/situation.hpp"

namespace biopsy::fault_injection {
namespace {

constexpr std::int64_t kTicksMax = 120'000;  // two minutes of procedure
constexpr std::size_t kWait_ticks = 20'000, kAfter_ticks = 350;
constexpr std::uint64_t kScenarios = 0x7363'656e;

std::vector<ProcedureState> rehearse(const Scenario& scenario) {
  std::vector<ProcedureState> seen;
  Procedure sound(scenario);
  std::int32_t steady = 0, before_mV = 0;
  for (std::int64_t k = 0; k < kTicksMax && !sound.over(); ++k) {
    const TickRecord line = sound.tick();
    steady = std::abs(line.command_mV - before_mV) > limits::kZeroVolt_mV ? 0 : steady + 1;
    before_mV = line.command_mV;
    seen.push_back({line.mode, line.command_mV, line.seen_um, steady, 0});
  }
  for (std::size_t i = seen.size(); i-- > 1;)
    if (seen[i - 1].mode == seen[i].mode) seen[i - 1].left = seen[i].left + 1;
  if (!sound.simulated_operator().completed()) seen.clear();
  return seen;
}

// The tick before one at which the class may begin: first its mode, then any tick of it, all alike.
std::optional<std::size_t> choose(Draw& draw, const FaultClass& fault,
                                  const std::vector<ProcedureState>& seen) {
  const auto modes = static_cast<std::int32_t>(fault.modes.size());
  const std::int32_t first = draw.whole(0, modes - 1);
  for (std::int32_t i = 0; i < modes; ++i) {
    const Mode mode = fault.modes[static_cast<std::size_t>((first + i) % modes)];
    std::vector<std::size_t> fitting;
    for (std::size_t k = 1; k < seen.size(); ++k)
      if (seen[k].mode == mode && seen[k].left > 0 && fault.fits(seen[k])) fitting.push_back(k);
    if (!fitting.empty())
      return fitting[static_cast<std::size_t>(draw.whole(0, static_cast<std::int32_t>(fitting.size()) - 1))];
  }
  return std::nullopt;
}

std::uint64_t number_of(const std::string& text) {  // FNV-1a
  std::uint64_t hash = 0xcbf2'9ce4'8422'2325;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100'0000'01b3;
  return hash;
}

void mask_hazards(Corruptors& corrupt, safety::HazardSet masked) {
  if (masked == 0) return;
  corrupt.input = [masked, before = std::move(corrupt.input)](safety::Situation& input) {
    if (before) before(input);
    input.evidence.clear |= masked;
  };
}

std::vector<TickRecord> watch(Procedure& procedure, const FaultClass& fault) {
  std::vector<TickRecord> lines;
  std::size_t done = 0;
  const safety::HazardSet names =
      fault.hazard == safety::Hazard::None ? 0 : bit(fault.hazard) | fault.instead;
  bool named = names == 0, shown = names != 0;
  while (lines.size() < kWait_ticks && (done == 0 || lines.size() < done + kAfter_ticks)) {
    const TickRecord line = procedure.tick();
    lines.push_back(line);
    named = named || (line.hazards & names) != 0;
    shown = shown || line.shown;
    if (done == 0 && named && shown && has_reacted(fault, line)) done = lines.size();
  }
  return lines;
}

// The sound procedures of one run, made once for all classes: the first scenario, and others where that one
// has no moment for a class.
class Rehearsals {
 public:
  Rehearsals(const Campaign& campaign, std::uint64_t run) : campaign_(campaign), run_(run) {}

  struct Moment {
    const Scenario& scenario;
    std::size_t tick;
  };
  Moment moment_for(const FaultClass& fault, Draw& draw) {
    for (std::size_t i = 0;; ++i) {
      if (i == scenarios_.size()) add();
      if (const auto tick = choose(draw, fault, seen_[i])) return {scenarios_[i], *tick};
    }
  }

 private:
  void add() {
    scenarios_.push_back(
        draw_scenario(campaign_.models, seed_of(campaign_.seed ^ kScenarios, scenarios_.size(), run_)));
    seen_.push_back(rehearse(scenarios_.back()));
  }

  const Campaign& campaign_;
  std::uint64_t run_;
  std::deque<Scenario> scenarios_;
  std::deque<std::vector<ProcedureState>> seen_;
};

RunResult run_in(Rehearsals& rehearsals, const Campaign& campaign, const FaultClass& fault,
                 std::uint64_t run) {
  Draw draw(seed_of(campaign.seed, number_of(fault.id), run));
  const Rehearsals::Moment moment = rehearsals.moment_for(fault, draw);
  Procedure procedure(moment.scenario);
  procedure.observe(campaign.observer);
  TickRecord line;
  for (std::size_t k = 0; k <= moment.tick; ++k) line = procedure.tick();
  Corruptors corruptors = fault.inject(draw, procedure, line);
  mask_hazards(corruptors, campaign.masked);
  procedure.corrupt(std::move(corruptors));
  RunResult result;
  result.mode = line.mode;
  result.tick = line.tick + 1;
  result.lines = watch(procedure, fault);
  result.verdict = evaluate(fault, result.lines, moment.scenario.plan.target_depth.value);
  return result;
}

void count(Tally& tally, const Verdict& verdict, std::uint64_t run) {
  ++tally.runs;
  tally.detected += verdict.outcome == Outcome::Detected;
  tally.by_another += verdict.outcome == Outcome::ByAnother;
  tally.late += verdict.outcome == Outcome::Late;
  tally.missed += verdict.outcome == Outcome::Missed;
  tally.not_shown += verdict.outcome == Outcome::NotShown;
  const bool deep = verdict.beyond_mm > kBeyondMax_mm && !tally.fault->moves_needle;
  const bool high = verdict.highest_kV > kDriveMax_kV;
  tally.too_deep += deep;
  tally.too_high += high;
  tally.rose += verdict.rose;
  tally.detect_ms = std::max(tally.detect_ms, verdict.detect_ms);
  tally.react_ms = std::max(tally.react_ms, verdict.react_ms);
  tally.from_fault_ms = std::max(tally.from_fault_ms, verdict.from_fault_ms);
  tally.beyond_mm = std::max(tally.beyond_mm, verdict.beyond_mm);
  tally.highest_kV = std::max(tally.highest_kV, verdict.highest_kV);
  const bool good = verdict.outcome == Outcome::Detected || verdict.outcome == Outcome::ByAnother;
  if (!good || deep || high || verdict.rose) tally.bad.push_back(run);
}

}  // namespace

RunResult run_one(const Campaign& campaign, const FaultClass& fault, std::uint64_t run) {
  Rehearsals rehearsals(campaign, run);
  return run_in(rehearsals, campaign, fault, run);
}

double lower_bound_95(std::int32_t hits, std::int32_t runs) {
  return boost::math::binomial_distribution<>::find_lower_bound_on_p(runs, hits, 0.05);
}

double Tally::coverage() const {
  return lower_bound_95(detected + by_another, runs);
}

std::vector<Tally> run_all(const Campaign& campaign, const std::vector<FaultClass>& faults, std::int32_t runs,
                           const std::function<void(double share)>& progress) {
  const auto each = static_cast<std::size_t>(runs);
  std::vector<std::vector<Verdict>> verdicts(each);
  std::atomic<std::size_t> done{0};
  in_parallel(each, [&](std::size_t run) {
    Rehearsals rehearsals(campaign, run);
    for (const FaultClass& fault : faults)
      verdicts[run].push_back(run_in(rehearsals, campaign, fault, run).verdict);
    progress(static_cast<double>(++done) / static_cast<double>(each));
  });
  std::vector<Tally> tallies(faults.size());
  for (std::size_t i = 0; i < faults.size(); ++i) {
    tallies[i].fault = &faults[i];
    for (std::size_t run = 0; run < each; ++run) count(tallies[i], verdicts[run][i], run);
  }
  return tallies;
}

}  // namespace biopsy::fault_injection
