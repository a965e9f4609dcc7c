#include "sim/paper/design/design_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "robot/common/text/number_text.hpp"

namespace biopsy::sim::design {
namespace {

struct Axis {
  double StackFigures::*member;
  const char* title;
  bool logarithmic = false;
};

constexpr Axis kStroke{&StackFigures::stroke_mm, "stroke (mm)"};
constexpr Axis kRipple{&StackFigures::ripple_mm, "ripple, peak to peak (mm)"};
constexpr Axis kBandwidth{&StackFigures::bandwidth_Hz, "bandwidth (Hz)"};
constexpr Axis kMargin{&StackFigures::breakdown_margin, "breakdown over field"};
constexpr Axis kHeight{&StackFigures::height_mm, "stack height (mm)"};

FigureCurve points(const std::string& name, const std::vector<DesignedStack>& stacks, const Axis& x,
                   const Axis& y) {
  FigureCurve curve;
  curve.name = name;
  curve.marks = true;
  curve.numbered = stacks.size() > 1;
  for (const DesignedStack& stack : stacks) {
    curve.x.push_back(stack.figures.*x.member);
    curve.y.push_back(stack.figures.*y.member);
  }
  return curve;
}

// From 0 to a little above the largest.
double top_of(const std::vector<FigureCurve>& curves, std::vector<double> FigureCurve::*axis) {
  double highest = 0.0;
  for (const FigureCurve& curve : curves)
    for (const double value : curve.*axis) highest = std::max(highest, value);
  return highest > 0.0 ? 1.08 * highest : 1.0;
}

FigurePanel panel(const std::string& title, const DesignStudy& study, const Axis& x, const Axis& y) {
  FigurePanel out{title, x.title, y.title, 0.0, 1.0, 0.0, 1.0, false, {}};
  out.curves = {points("Pareto-optimal designs", study.best, x, y),
                points("the paper's", {study.paper}, x, y)};
  out.x_high = top_of(out.curves, &FigureCurve::x);
  out.y_high = top_of(out.curves, &FigureCurve::y);
  return out;
}

double distance(const DesignedStack& a, const DesignedStack& b) {
  double sum = 0.0;
  for (const Axis& axis : {kStroke, kRipple, kBandwidth, kMargin, kHeight}) {
    const double x = a.figures.*axis.member, y = b.figures.*axis.member;
    sum += std::pow((x - y) / std::max({std::abs(x), std::abs(y), 1e-9}), 2);
  }
  return sum;
}

// Greedy: the design farthest from those already taken, beginning with the largest stroke.
std::vector<DesignedStack> spread(std::vector<DesignedStack> all, std::size_t count) {
  const auto by_stroke = [](const DesignedStack& a, const DesignedStack& b) {
    return a.figures.stroke_mm < b.figures.stroke_mm;
  };
  std::stable_sort(all.begin(), all.end(), by_stroke);
  if (all.size() <= count) return all;
  std::vector<DesignedStack> taken{all.back()};
  std::vector<double> nearest(all.size(), HUGE_VAL);
  while (taken.size() < count) {
    for (std::size_t i = 0; i < all.size(); ++i)
      nearest[i] = std::min(nearest[i], distance(all[i], taken.back()));
    taken.push_back(
        all[static_cast<std::size_t>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin())]);
  }
  std::stable_sort(taken.begin(), taken.end(), by_stroke);
  return taken;
}

// Up to half of them dominate the paper's design.
std::vector<DesignedStack> chosen(std::vector<DesignedStack> best, const DesignedStack& paper) {
  const auto others = std::stable_partition(best.begin(), best.end(),
                                            [&](const DesignedStack& s) { return beats(s, paper); });
  std::vector<DesignedStack> out = spread({best.begin(), others}, kShown / 2);
  const std::vector<DesignedStack> rest = spread({others, best.end()}, kShown - out.size());
  out.insert(out.end(), rest.begin(), rest.end());
  return spread(std::move(out), kShown);
}

std::vector<std::string> demand_texts(const Demands& d) {
  return {
      fmt::format(
          "Stroke of {:.3g} mm or more against {:.2g} N of tissue: the paper's deepest insertion is 3.5 "
          "mm (IV.F.2), and a capsule needs about that force (sim/models/tissues.toml).",
          d.stroke_mm, d.push_N),
      fmt::format(
          "The film's guaranteed AC strength is {:.2g} times the peak field or more. Strength: DuPont Kapton "
          "HN, bulletin GS-96-7, minimum by ASTM D149 (25 um: 236, 50 um: 197, 75 um: 177, 125 um: 118 "
          "V/um; linear between). The tests are short, on small areas without edges or folds: hence the "
          "factor. Field: the whole amplifier voltage over both films, as if nothing else held a share of it "
          "(K = 1). K is fitted and uncertain, and what shares the voltage may fail first.",
          d.margin),
      fmt::format("The stack is {:.3g} mm high at rest or less: it is placed beside a patient in a bore.",
                  d.height_mm),
      fmt::format(
          "Strain of {:.3g} % or less: the paper measured 50 % (IV.C), and far beyond it eq. (18) is not "
          "validated.",
          100.0 * d.strain),
      std::string("The oil lies flat at rest: S + pi H_0/2 of eq. (18) is not longer than a chamber (half "
                  "the pouch less its seam of 3 mm). More oil thickens the pouch before any voltage.")};
}

std::vector<std::string> assumptions() {
  return {
      std::string(
          "Oil volume scales V0, the pouch's side L0, films d_film; electrodes, films and number of pouches "
          "scale C2, and 1/R with it (a material's R C2 is constant). C1 is the cable's and stays."),
      std::string(
          "Oil flow: tau_h grows as (chamber's length over the oil's mean thickness)^2 over the films' "
          "pressure, as a viscous film's does (Reynolds' lubrication equation), from the paper's stack at 6 "
          "kV. "
          "The paper gives no second stack to confirm it. Guide damping and masses stay as they are."),
      std::string("The paper's own film of 25 um leaks far more slowly than by this scaling (Fig. 6; "
                  "sim/models/paper.toml): such designs would ripple less than shown, with a slightly lower "
                  "peak field."),
      std::string("Dry friction of the guide, the play of zipping and errors of the laser are left out: they "
                  "hide ripple."),
      std::string(
          "Ripple: plate A, peak to peak, under a 2 Hz square wave in the periodic state, 50 g, against the "
          "push. Bandwidth: linearised, for small changes of amplitude; a lightly damped spring peaks below "
          "it, "
          "which the controller has to allow for (`biopsy tune`)."),
      std::string("The films' stiffness, ageing, partial discharge and the yield of welding thin films are "
                  "not in the model.")};
}

}  // namespace

DesignStudy study_designs(const PlantModel& known, const std::string& name, const Demands& demands,
                          const SearchSize& size, const Progress& progress) {
  const auto started = std::chrono::steady_clock::now();
  DesignStudy study;
  study.model = name;
  study.paper = evaluate(known, design_of(known), demands);
  const std::vector<DesignedStack> seen = search(
      study.paper, [&](const StackDesign& design) { return evaluate(known, design, demands); }, size,
      progress);
  std::vector<DesignedStack> meeting;
  for (const DesignedStack& stack : seen)
    if (stack.broken.empty()) meeting.push_back(stack);
  study.best = chosen(unbeaten(meeting), study.paper);
  study.evaluated = seen.size();
  study.demands = demand_texts(demands);
  study.assumed = assumptions();
  study.interrupted = size.stop.stop_requested();
  if (study.interrupted)
    study.assumed.insert(study.assumed.begin(),
                         fmt::format("The search was interrupted after {}: others may be better.",
                                     counted(study.evaluated, "design")));
  study.panels = {panel("Stroke against stack height", study, kHeight, kStroke),
                  panel("Stroke against ripple", study, kRipple, kStroke),
                  panel("Stroke against breakdown margin", study, kMargin, kStroke),
                  panel("Bandwidth against ripple", study, kRipple, kBandwidth)};
  study.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return study;
}

}  // namespace biopsy::sim::design
