#include "sim/gap/select/keep_simpler.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sim/gap/select/told_apart.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kLittle = 0.5;  // noises that are left, and need no name of their own
constexpr double kBehind = 1.0;  // log evidence, of the richer name
constexpr double kBeyondDoubt = 10.0;

bool slides_at_more(const CandidateFit& fit) {
  if (!is_effect(fit.candidate, StribeckFriction::info.name)) return false;
  const StribeckFriction& friction = *fit.scored.hypothesis.model.effects.stribeck_friction;
  return friction.sliding >= friction.breakaway;
}

}  // namespace

bool bends_unseen(const CandidateFit& fit, const Evidence& evidence) {
  if (!fit.fitted || !is_effect(fit.candidate, LugreFriction::info.name)) return false;
  const LugreFriction& friction = *fit.scored.hypothesis.model.effects.lugre_friction;
  return friction.steady(0.0) < kBendSeen * evidence.noise * friction.stiffness;
}

void keep_simpler(Round& round, const Evidence& evidence) {
  const auto find = [&](std::string_view name) {
    return std::ranges::find_if(
        round.fits, [&](const CandidateFit& t) { return t.fitted && is_effect(t.candidate, name); });
  };
  constexpr auto kCoulomb = CoulombFriction::info.name, kStribeck = StribeckFriction::info.name,
                 kYields = HystereticSpring::info.name, kLugre = LugreFriction::info.name;
  constexpr std::array kContained{std::pair{kCoulomb, kStribeck}, std::pair{kCoulomb, kYields},
                                  std::pair{kCoulomb, kLugre}, std::pair{kStribeck, kLugre}};
  for (const auto& [contained, containing] : kContained) {
    const auto simple = find(contained), rich = find(containing);
    if (simple == round.fits.end() || rich == round.fits.end()) continue;
    const bool leaves_much = std::sqrt(excess(simple->scored.square, evidence)) > kLittle * evidence.noise;
    const bool ahead = rich->log_evidence > simple->log_evidence + kBeyondDoubt ||
                       paired_evidence(rich->scored, simple->scored, evidence) > kBeyondDoubt;
    const bool shown = slides_at_more(*rich) ? leaves_much && ahead : leaves_much || ahead;
    if (shown && !bends_unseen(*rich, evidence)) continue;
    rich->log_evidence = std::min(rich->log_evidence, simple->log_evidence - kBehind);
  }
}

}  // namespace biopsy::sim::gap
