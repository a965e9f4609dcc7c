#include "tests/verification/model_checking/supervisor/explorer.hpp"

#include <algorithm>
#include <bit>
#include <set>

#include "tests/safety/situation.hpp"
#include "tests/verification/model_checking/supervisor/backward_reachability.hpp"
#include "tests/verification/model_checking/supervisor/equivalent_step.hpp"
#include "tests/verification/model_checking/supervisor/permissiveness.hpp"
#include "tests/verification/model_checking/supervisor/states.hpp"

namespace biopsy::model_checking {
namespace {

// Inputs tried at each tick besides one of each kind, scattered over the product by a large prime.
constexpr std::uint32_t kOthers = 8;
constexpr std::uint64_t kScatter = 2'654'435'761;

bool is_healthy(const Situation& input) {
  return input.evidence.hazards() == 0 && input.stop == StopCategory::None && input.evidence.zero_volts &&
         input.evidence.needle_home && input.self_test == safety::SelfTest::Passed;
}

// Its next tick locks, whatever comes: the one state from which there is no way to Safe.
bool is_boot_out_of_time(const SupervisorState& state) {
  return state.mode == Mode::Boot && state.ms_in_mode == 10'000 - 1;
}

}  // namespace

std::string_view name_of_claim(std::size_t claim) {
  constexpr std::array<std::string_view, kGraphClaims> kNames{
      "worse-never-permits-more", "forgotten-decides-nothing", "time-between-is-alike", "every-mode-reached",
      "safe-reachable"};
  return claim < kInvariants ? kInvariantTable[claim].name : kNames.at(claim - kInvariants);
}

std::string_view sentence_of_claim(std::size_t claim) {
  constexpr std::array<std::string_view, kGraphClaims> kSentences{
      "An input that is worse in one respect never gives a more permissive output.",
      "What the exploration forgets decides nothing: a equivalent of each step does the same, also with arm "
      "and "
      "reset asked "
      "over the network.",
      "Between the first and the last ticks of a time every input does what it does in the first.",
      "Every mode is reached.",
      "From every state but Lock some healthy script reaches Safe (not from Boot in the tick its 10 s run "
      "out)."};
  return claim < kInvariants ? kInvariantTable[claim].sentence : kSentences.at(claim - kInvariants);
}

std::uint64_t Exploration::violations() const {
  std::uint64_t sum = 0;
  for (const ClaimTally& claim : claims) sum += claim.broken;
  return sum;
}

Explorer::Explorer(const Subject& subject, const PlanFacts& plan, const ExploreOptions& options)
    : subject_(subject), plan_(plan), options_(options) {
  for (std::size_t mode = 0; mode < safety::kModes; ++mode)
    spaces_.emplace_back(static_cast<Mode>(mode), options.grain);
}

Exploration Explorer::run() {
  const std::uint64_t start = key_of(safety::started(kSession));
  index_.number_of(start, 0);
  keys_.push_back(start);
  parents_.push_back(0);
  via_.push_back(0);
  for (std::uint32_t from = 0; from < keys_.size() && !is_enough(); ++from) {
    const auto kinds = kinds_.find(without_timer(keys_[from]));
    if (kinds == kinds_.end() || is_edge_of_time(state(from)))
      sweep(from);
    else
      walk(from, kinds->second);
  }
  count_applied();
  result_.states = keys_.size();
  if (!is_enough()) check_graph();
  return result_;
}

// Every input; remembers one of each kind, distinguished by what the step did.
void Explorer::sweep(std::uint32_t from) {
  const SupervisorState before = state(from);
  const InputSpace& space = inputs_of(before.mode);
  outcomes_.resize(space.size());
  std::set<std::pair<std::uint64_t, std::uint64_t>> known;
  std::pair<std::uint64_t, std::uint64_t> last{~0ULL, ~0ULL};
  std::vector<Kind> kinds;
  space.for_each(before, [&](std::uint32_t index, const Situation& input) {
    take(from, before, input, index);
    outcomes_[index] = outcome_of(after_, output_);
    const std::pair kind{key_of(after_) << 1U | (is_healthy(input) ? 1U : 0U), outcomes_[index]};
    if (kind == last || !known.insert(last = kind).second) return;
    kinds.push_back({index, input});
    go(from, input, index);
  });
  compare_with_worse(from, before);
  kinds_.try_emplace(without_timer(keys_[from]), std::move(kinds));
}

void Explorer::walk(std::uint32_t from, const std::vector<Kind>& kinds) {
  const SupervisorState before = state(from);
  const InputSpace& space = inputs_of(before.mode);
  for (const Kind& kind : kinds) walk(from, before, kind);
  for (std::uint32_t i = 0; i < kOthers; ++i) {
    const auto index =
        static_cast<std::uint32_t>((std::uint64_t{from} * kOthers + i) * kScatter % space.size());
    walk(from, before, {index, space.at(index, before)});
  }
}

void Explorer::walk(std::uint32_t from, const SupervisorState& before, const Kind& kind) {
  take(from, before, kind.input, kind.index);
  go(from, kind.input, kind.index);
  const SupervisorState first = state_of(without_timer(keys_[from]));
  SupervisorState after;
  SupervisorOutput output;
  subject_.step(&plan_, &first, &kind.input, &after, &output);
  ++tally(GraphClaim::TimeBetweenIsAlike).checked;
  if (output.event != output_.event || without_timer(key_of(after)) != without_timer(key_of(after_)))
    break_claim(GraphClaim::TimeBetweenIsAlike, from, kind.index, {});
}

void Explorer::take(std::uint32_t from, const SupervisorState& before, const Situation& input,
                    std::uint32_t index) {
  subject_.step(&plan_, &before, &input, &after_, &output_);
  ++result_.transitions;
  note(check_all({plan_, before, input, after_, output_}), from, index);
  try_equivalent(before, input, from, index);
}

void Explorer::try_equivalent(const SupervisorState& before, const Situation& input, std::uint32_t from,
                              std::uint32_t index) {
  const EquivalentStep equivalent = equivalent_step(before, input, (std::uint64_t{from} << 32U) + index);
  SupervisorState after;
  SupervisorOutput output;
  subject_.step(&plan_, &equivalent.state, &equivalent.input, &after, &output);
  ++result_.equivalent_steps;
  if (!has_equal_outcome(after_, output_, equivalent.state, after, output))
    break_claim(GraphClaim::ForgottenDecidesNothing, from, index, {});
}

void Explorer::compare_with_worse(std::uint32_t from, const SupervisorState& before) {
  const InputSpace& space = inputs_of(before.mode);
  const std::int32_t held_mV = envelope_mV(plan_, before, {});  // in Active nothing: no ceiling
  for (std::size_t d = 0; d < kDimensions; ++d) {
    const std::uint32_t stride = space.stride_of(static_cast<Dimension>(d));
    const std::uint32_t block = stride * space.size_of(static_cast<Dimension>(d));
    for (const auto& [good, bad] : space.worse(static_cast<Dimension>(d)))
      for (std::uint32_t at = 0; at < space.size(); at += block)
        for (std::uint32_t i = at; i < at + stride; ++i) {
          ++result_.pairs;
          const std::uint32_t better = i + good * stride, worse = i + bad * stride;
          if (outcomes_[better] == outcomes_[worse]) continue;
          if (!is_no_more_permissive(outcomes_[worse], outcomes_[better], held_mV))
            break_claim(GraphClaim::WorseNeverPermitsMore, from, better, worse);
        }
  }
}

void Explorer::go(std::uint32_t from, const Situation& input, std::uint32_t index) {
  const std::uint64_t key = key_of(after_);
  const auto [to, is_new] = index_.number_of(key, static_cast<std::uint32_t>(keys_.size()));
  if (is_healthy(input)) healthy_.emplace_back(from, to);
  if (!is_new) return;
  keys_.push_back(key);
  parents_.push_back(from);
  via_.push_back(index);
}

// Which invariants applied is the same for long runs of inputs: counted by the run.
void Explorer::note(Findings findings, std::uint32_t from, std::uint32_t input) {
  if (findings.applied != applied_) count_applied(), applied_ = findings.applied;
  ++applied_times_;
  for (std::uint64_t broken = findings.broken; broken != 0; broken &= broken - 1)
    break_claim(static_cast<std::size_t>(std::countr_zero(broken)), from, input, {});
}

void Explorer::count_applied() {
  for (std::uint64_t bits = applied_; bits != 0; bits &= bits - 1)
    result_.claims[static_cast<std::size_t>(std::countr_zero(bits))].checked += applied_times_;
  applied_times_ = 0;
}

void Explorer::break_claim(std::size_t claim, std::uint32_t from, std::uint32_t input,
                           std::optional<std::uint32_t> worse) {
  ClaimTally& tally = result_.claims[claim];
  if (tally.broken++ == 0) tally.first = Counterexample{from, input, worse};
  if (((options_.excused >> claim) & 1U) == 0) ++broken_;
}

static_assert(kClaims <= 64);

bool Explorer::is_enough() const {
  return options_.enough != 0 && broken_ >= options_.enough;
}

void Explorer::break_claim(GraphClaim claim, std::uint32_t from, std::uint32_t input,
                           std::optional<std::uint32_t> worse) {
  break_claim(kInvariants + static_cast<std::size_t>(claim), from, input, worse);
}

void Explorer::check_graph() {
  tally(GraphClaim::ForgottenDecidesNothing).checked = result_.equivalent_steps;
  tally(GraphClaim::WorseNeverPermitsMore).checked = result_.pairs;
  for (std::uint32_t i = 0; i < keys_.size(); ++i) {
    const SupervisorState s = state(i);
    const auto mode = static_cast<std::size_t>(s.mode);
    ++result_.states_of_mode.at(mode);
    result_.longest_ticks.at(mode) = std::max(result_.longest_ticks.at(mode), s.ms_in_mode + 1);
  }
  for (std::size_t mode = 0; mode < safety::kModes; ++mode) {
    ++tally(GraphClaim::EveryModeReached).checked;
    if (result_.states_of_mode.at(mode) == 0) break_claim(GraphClaim::EveryModeReached, 0, 0, {});
  }
  check_safe_reachable();
}

void Explorer::check_safe_reachable() {
  const std::vector<std::uint32_t> ticks = ticks_to_safe(keys_, healthy_);
  for (std::uint32_t i = 0; i < keys_.size(); ++i) {
    if (state(i).mode == Mode::Lock || is_boot_out_of_time(state(i))) continue;
    ++tally(GraphClaim::SafeReachable).checked;
    if (ticks[i] == kNever)
      break_claim(GraphClaim::SafeReachable, i, 0, {});
    else
      result_.longest_to_safe_ticks = std::max(result_.longest_to_safe_ticks, ticks[i]);
  }
}

std::vector<std::uint32_t> Explorer::way_to(std::uint32_t state) const {
  std::vector<std::uint32_t> way;
  for (; state != 0; state = parents_[state]) way.push_back(via_[state]);
  std::ranges::reverse(way);
  return way;
}

}  // namespace biopsy::model_checking
