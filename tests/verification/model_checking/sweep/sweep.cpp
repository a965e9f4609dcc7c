#include "tests/verification/model_checking/sweep/sweep.hpp"

#include <algorithm>
#include <cstring>
#include <map>
#include <mutex>
#include <set>
#include <tuple>

#include "tests/verification/model_checking/sweep/permissiveness.hpp"
#include "tests/verification/model_checking/sweep/step_checker.hpp"

namespace biopsy::model_checking {
namespace {

constexpr std::uint32_t kRun = 1U << 16U;  // inputs that one worker takes

// What a step did, as far as inputs are told apart by it: state after, whether healthy, what was allowed.
using Did = std::tuple<std::uint64_t, bool, std::uint64_t>;

class Sweeper {
 public:
  Sweeper(const Subject& subject, const PlanFacts& plan, const InputSpace& space, std::uint32_t from,
          const SupervisorState& before)
      : subject_(subject), plan_(plan), space_(space), from_(from), before_(before), numbers_(space.size()) {}

  Sweep run(Spread spread) {
    std::vector<Run> runs((space_.size() + kRun - 1) / kRun);
    spread(runs.size(), [&](std::size_t i) { take(static_cast<std::uint32_t>(i), runs[i]); });
    Sweep all;
    std::set<Did> known;
    for (Run& run : runs) {
      all.tallies.add(run.tallies);
      for (auto& [did, kind] : run.kinds)
        if (known.insert(did).second) all.kinds.push_back(std::move(kind));
    }
    all.steps = space_.size();
    all.pairs = compare_with_worse(spread, all.tallies);
    return all;
  }

 private:
  struct Run {
    Tallies tallies;
    std::vector<std::pair<Did, Kind>> kinds;
  };

  void take(std::uint32_t number, Run& run) {
    const std::uint32_t first = number * kRun, end = std::min(first + kRun, space_.size());
    StepChecker checker(subject_, plan_);
    std::map<Did, Outcomes::Number> known;
    auto last = known.end();
    space_.for_each(first, end, before_, [&](std::uint32_t index, const Situation& input) {
      std::uint64_t key = 0;
      const auto [after, output] = checker.take(from_, before_, input, index, key);
      const Did did{key, is_healthy(input), outcome_of(after, output)};
      if (last == known.end() || last->first != did) {
        last = known.lower_bound(did);
        if (last == known.end() || last->first != did) {
          last = known.emplace_hint(last, did, outcomes_.number_of(std::get<2>(did)));
          run.kinds.emplace_back(did, Kind{index, input, key});
        }
      }
      numbers_[index] = last->second;
    });
    run.tallies = checker.take_tallies();
  }

  std::uint64_t compare_with_worse(Spread spread, Tallies& tallies) const {
    struct Compared {
      Tallies tallies;
      std::uint64_t pairs = 0;
    };
    const std::vector<bool> fine =
        outcomes_.no_more_permissive(envelope_mV(plan_, before_, {}));  // no ceiling
    std::vector<Compared> of_dimension(kDimensions);
    spread(kDimensions, [&](std::size_t d) {
      of_dimension[d].pairs = compare_with_worse(static_cast<Dimension>(d), fine, of_dimension[d].tallies);
    });
    std::uint64_t pairs = 0;
    for (const Compared& compared : of_dimension) tallies.add(compared.tallies), pairs += compared.pairs;
    return pairs;
  }

  std::uint64_t compare_with_worse(Dimension d, const std::vector<bool>& fine, Tallies& tallies) const {
    std::uint64_t pairs = 0;
    const std::uint32_t stride = space_.stride_of(d), block = stride * space_.size_of(d);
    for (std::uint32_t at = 0; at < space_.size(); at += block)
      for (const auto& [good, bad] : space_.worse(d)) {
        pairs += stride;
        const std::uint32_t better = at + good * stride, worse = at + bad * stride;
        if (std::memcmp(&numbers_[better], &numbers_[worse], stride * sizeof numbers_[0]) == 0) continue;
        for (std::uint32_t i = 0; i < stride; ++i)
          if (numbers_[worse + i] != numbers_[better + i] &&
              !fine[numbers_[worse + i] * outcomes_.size() + numbers_[better + i]])
            tallies.break_claim(GraphClaim::WorseNeverPermitsMore, {from_, better + i, worse + i});
      }
    return pairs;
  }

  const Subject& subject_;
  const PlanFacts& plan_;
  const InputSpace& space_;
  std::uint32_t from_;
  const SupervisorState& before_;
  Outcomes outcomes_;
  std::vector<Outcomes::Number> numbers_;  // of the outcome of each input
};

}  // namespace

bool is_healthy(const Situation& input) {
  return input.evidence.hazards() == 0 && input.stop == StopCategory::None && input.evidence.zero_volts &&
         input.evidence.needle_home && input.self_test == safety::SelfTest::Passed;
}

Sweep sweep(const Subject& subject, const PlanFacts& plan, const InputSpace& space, std::uint32_t from,
            const SupervisorState& before, Spread spread) {
  return Sweeper(subject, plan, space, from, before).run(spread);
}

}  // namespace biopsy::model_checking
