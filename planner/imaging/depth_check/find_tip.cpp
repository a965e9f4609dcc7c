#include "planner/imaging/depth_check/find_tip.hpp"

#include <algorithm>
#include <cmath>

#include "planner/imaging/depth_check/void_fit.hpp"
#include "planner/imaging/depth_check/void_line.hpp"

namespace biopsy::imaging {
namespace {

// Longest stretch after the entry and before the tip where the void is clearly missing: its loss is below 0.4
// of the rest's and known well enough to say so. `inflation`: of a variance, over that of independent voxels.
double longest_gap(const LineProfile& profile, const VoidFit& fit) {
  constexpr std::size_t kStretch = 6;  // 3 mm of half-millimetre bins
  double longest = 0.0, current = 0.0;
  for (std::size_t bin = 0; bin + kStretch <= profile.match.size(); ++bin) {
    if (profile.at(bin) < std::max(profile.t_min, 0.0) || profile.at(bin + kStretch) > fit.depth_mm) continue;
    double match = 0.0, energy = 0.0;
    for (std::size_t n = bin; n < bin + kStretch; ++n) match += profile.match[n], energy += profile.energy[n];
    const double loss = energy > 0.0 ? match / energy : 0.0,
                 sigma = energy > 0.0 ? std::sqrt(fit.inflation / energy) : 1.0;
    const bool missing = loss + 2.0 * sigma < 0.4 * fit.loss;
    current = missing ? (current > 0.0 ? current + profile.bin_mm : profile.bin_mm * kStretch) : 0.0;
    longest = std::max(longest, current);
  }
  return longest;
}

// Evidence that a 1 mm void losing half its signal would give over the first 10 mm of the path.
double visibility(const LineSearch& search, const Corridor& corridor, double inflation) {
  const LineProfile profile = search.profile(VoidLine{});
  double energy = 0.0;
  for (std::size_t n = 0; n < profile.energy.size(); ++n)
    if (profile.at(n) >= std::max(corridor.t_min, 0.0) &&
        profile.at(n) < std::max(corridor.t_min, 0.0) + 10.0)
      energy += profile.energy[n];
  return 0.5 * std::sqrt(energy / inflation);
}

// Likelihood of the void's end at every depth, as wide about the fit as the errors measured beside it.
void weigh_depths(const Corridor& corridor, const VoidFit& fit, const SearchReach& reach, TipFinding& found) {
  constexpr double kStep_mm = 0.1;
  const double from = std::max(reach.depth_min_mm, corridor.t_min);
  for (double depth = from; depth <= std::min(corridor.t_max, reach.depth_max_mm) + 2.0; depth += kStep_mm)
    found.depths_mm.push_back(depth);
  const std::vector<double> chi2 = chi2_by_depth(corridor, fit, found.depths_mm);
  if (chi2.empty()) return;
  const double least = *std::min_element(chi2.begin(), chi2.end());
  const auto weigh = [&](double inflation) {
    double total = 0.0, first = 0.0, second = 0.0;
    found.weights.clear();
    for (std::size_t n = 0; n < chi2.size(); ++n) {
      const double weight = std::exp(-0.5 * (chi2[n] - least) / inflation);
      const double off = found.depths_mm[n] - fit.depth_mm;
      found.weights.push_back(weight);
      total += weight, first += weight * off, second += weight * off * off;
    }
    for (double& weight : found.weights) weight /= total;
    found.depth_mm = fit.depth_mm + first / total;
    return second / total - std::pow(first / total, 2);
  };
  // Independent voxels would give a variance near the fit; the measured one is larger by the inflation
  // sought.
  const double wanted = fit.covariance(kDepth, kDepth);
  double alone = 0.0, weight_alone = 0.0;
  for (std::size_t n = 0; n < chi2.size(); ++n) {
    const double weight = std::exp(-0.5 * (chi2[n] - least)), off = found.depths_mm[n] - fit.depth_mm;
    if (std::abs(off) < 5.0) alone += weight * off * off, weight_alone += weight;
  }
  alone = weight_alone > 0.0 ? std::max(alone / weight_alone, 1e-4) : wanted;
  double inflation = std::max(wanted / alone, 1.0), variance = weigh(inflation);
  // A likelihood that is not normal: as wide as measured, or as wide as it gets.
  for (int n = 0; n < 20 && variance < wanted; ++n) variance = weigh(inflation *= 1.3);
  found.sigma_mm = std::sqrt(std::max(variance, wanted));
  // Where the tissue ahead is dark in both images, the void's end could lie anywhere in it: the shortest
  // depth that is half as likely as the likeliest is what was seen.
  constexpr double kAmbiguous_mm = 1.0;
  const double likely = 0.5 * *std::max_element(found.weights.begin(), found.weights.end());
  if (found.sigma_mm > kAmbiguous_mm)
    for (std::size_t n = found.weights.size(); n-- > 0;)
      if (found.weights[n] >= likely) found.depth_mm = found.depths_mm[n];
}

}  // namespace

TipFinding find_tip(const Corridor& corridor, const SearchReach& reach) {
  const LineSearch search(corridor, reach.depth_min_mm, reach.depth_max_mm);
  const std::vector<LineCandidate> tops = line_candidates(corridor, reach);
  TipFinding found;
  found.seen_to_mm = corridor.t_max;
  constexpr std::ptrdiff_t kFitted = 3;
  const VoidFit fit = fit_void(corridor, {tops.begin(), tops.begin() + kFitted}, reach);
  if (fit.gain <= 0.0) {
    if (!fit.led_away) found.visible = visibility(search, corridor, 1.0);
    return found;
  }
  found.loss = fit.loss;
  found.loss_sigma = fit.loss_sigma;
  found.evidence = fit.evidence();
  found.visible = visibility(search, corridor, fit.inflation);
  found.control_places = fit.control_places;
  found.radius_mm = fit.line.radius_mm;
  weigh_depths(corridor, fit, reach, found);
  found.beside_mm = {{fit.u_mm, fit.v_mm}, fit.covariance.block<2, 2>(kU, kU), fit.other_place};
  found.slope = {
      {fit.line.u_slope, fit.line.v_slope}, fit.covariance.block<2, 2>(kUSlope, kUSlope), fit.other_slope};
  found.gap_mm = longest_gap(search.profile(fit.line), fit);
  found.at_end = fit.depth_mm > corridor.t_max - std::max(1.0, 0.5 * corridor.along_mm);
  return found;
}

}  // namespace biopsy::imaging
