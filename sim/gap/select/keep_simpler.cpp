#include "sim/gap/select/keep_simpler.hpp"

#include <algorithm>
#include <cmath>

#include "sim/gap/select/told_apart.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kLittle = 0.5;  // noises that are left, and need no name of their own
constexpr double kBehind = 1.0;  // log evidence, of the richer name
constexpr double kBeyondDoubt = 10.0;

bool slides_at_more(const ScoredModel& scored) {
  const auto& friction = scored.hypothesis.model.effects.stribeck_friction;
  return friction && friction->sliding >= friction->breakaway;
}

}  // namespace

void keep_simpler(Round& round, const Evidence& evidence) {
  const auto find = [&](std::string_view name) {
    return std::ranges::find_if(
        round.fits, [&](const CandidateFit& t) { return t.fitted && is_effect(t.candidate, name); });
  };
  const auto simple = find(CoulombFriction::info.name);
  if (simple == round.fits.end()) return;
  const bool leaves_much = std::sqrt(excess(simple->scored.square, evidence)) > kLittle * evidence.noise;
  for (const std::string_view name : {StribeckFriction::info.name, HystereticSpring::info.name}) {
    const auto rich = find(name);
    if (rich == round.fits.end()) continue;
    const bool ahead = rich->log_evidence > simple->log_evidence + kBeyondDoubt ||
                       paired_evidence(rich->scored, simple->scored, evidence) > kBeyondDoubt;
    if (slides_at_more(rich->scored) ? leaves_much && ahead : leaves_much || ahead) continue;
    rich->log_evidence = std::min(rich->log_evidence, simple->log_evidence - kBehind);
  }
}

}  // namespace biopsy::sim::gap
