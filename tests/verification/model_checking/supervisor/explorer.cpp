#include "tests/verification/model_checking/supervisor/explorer.hpp"

#include <algorithm>

#include "tests/safety/situation.hpp"
#include "tests/verification/model_checking/supervisor/backward_reachability.hpp"
#include "tests/verification/model_checking/supervisor/states.hpp"

namespace biopsy::model_checking {
namespace {

// Inputs tried at each tick besides one of each kind, scattered over the product by a large prime.
constexpr std::uint32_t kOthers = 8;
constexpr std::uint64_t kScatter = 2'654'435'761;

// Its next tick locks, whatever comes: the one state from which there is no way to Safe.
bool is_boot_out_of_time(const SupervisorState& state) {
  return state.mode == Mode::Boot && state.ms_in_mode == 10'000 - 1;
}

}  // namespace

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
      sweep_all(from);
    else
      walk(from, kinds->second);
  }
  result_.equivalent_steps = result_.transitions;  // one beside each
  result_.states = keys_.size();
  if (!is_enough()) check_graph();
  return result_;
}

// Every input; remembers one of each kind, distinguished by what the step did.
void Explorer::sweep_all(std::uint32_t from) {
  const SupervisorState before = state(from);
  Sweep swept = sweep(subject_, plan_, inputs_of(before.mode), from, before, options_.spread);
  result_.transitions += swept.steps;
  result_.pairs += swept.pairs;
  result_.tallies.add(swept.tallies);
  for (const Kind& kind : swept.kinds) go(from, kind);
  kinds_.try_emplace(without_timer(keys_[from]), std::move(swept.kinds));
}

void Explorer::walk(std::uint32_t from, const std::vector<Kind>& kinds) {
  const SupervisorState before = state(from);
  const InputSpace& space = inputs_of(before.mode);
  for (const Kind& kind : kinds) walk(from, before, kind);
  for (std::uint32_t i = 0; i < kOthers; ++i) {
    const auto index =
        static_cast<std::uint32_t>((std::uint64_t{from} * kOthers + i) * kScatter % space.size());
    walk(from, before, {index, space.at(index, before), 0});
  }
  result_.tallies.add(checker_.take_tallies());
}

void Explorer::walk(std::uint32_t from, const SupervisorState& before, const Kind& kind) {
  std::uint64_t key = 0;
  const auto [next, decided] = checker_.take(from, before, kind.input, kind.index, key);
  ++result_.transitions;
  go(from, {kind.index, kind.input, key});
  const SupervisorState first = state_of(without_timer(keys_[from]));
  const auto [after, output] = subject_.step(&plan_, &first, &kind.input);
  ++result_.tallies.claims[number_of(GraphClaim::TimeBetweenIsAlike)].checked;
  if (output.event != decided.event || without_timer(key_of(after)) != without_timer(key))
    result_.tallies.break_claim(GraphClaim::TimeBetweenIsAlike, {from, kind.index, {}});
}

void Explorer::go(std::uint32_t from, const Kind& kind) {
  const auto [to, is_new] = index_.number_of(kind.key, static_cast<std::uint32_t>(keys_.size()));
  if (is_healthy(kind.input)) healthy_.emplace_back(from, to);
  if (!is_new) return;
  keys_.push_back(kind.key);
  parents_.push_back(from);
  via_.push_back(kind.index);
}

bool Explorer::is_enough() const {
  return options_.enough != 0 && result_.tallies.broken(options_.excused) >= options_.enough;
}

void Explorer::check_graph() {
  const auto tally = [this](GraphClaim claim) -> ClaimTally& {
    return result_.tallies.claims[number_of(claim)];
  };
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
    if (result_.states_of_mode.at(mode) == 0) result_.tallies.break_claim(GraphClaim::EveryModeReached, {});
  }
  check_safe_reachable();
}

void Explorer::check_safe_reachable() {
  const std::vector<std::uint32_t> ticks = ticks_to_safe(keys_, healthy_);
  for (std::uint32_t i = 0; i < keys_.size(); ++i) {
    if (state(i).mode == Mode::Lock || is_boot_out_of_time(state(i))) continue;
    ++result_.tallies.claims[number_of(GraphClaim::SafeReachable)].checked;
    if (ticks[i] == kNever)
      result_.tallies.break_claim(GraphClaim::SafeReachable, {i, 0, {}});
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
