#include "sim/paper/tuning/tune.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "robot/common/config_error.hpp"
#include "robot/common/in_parallel.hpp"
#include "sim/paper/paper_targets.hpp"
#include "sim/paper/tuning/linear_stage.hpp"
#include "sim/paper/tuning/respects.hpp"
#include "sim/paper/tuning/score.hpp"
#include "sim/paper/tuning/tuning_panels.hpp"
#include "sim/paper/tuning/uncertainty.hpp"

namespace biopsy::sim::tuning {
namespace {

constexpr std::array kDepths{1.0, 3.0, 5.0, 8.0};   // mm, of which those within the stroke
constexpr std::size_t kBest = 10;                   // of the first grid are evaluated on all stages
constexpr std::array kSpeeds{4.0, 6.0, 8.0, 12.0};  // mm/s
constexpr int kFiner = 2;                           // rounds around the best

// A stage linearised at one depth.
struct AtDepth {
  double depth;
  LinearStage linear;
  std::vector<std::complex<double>> response;
};

struct Known {
  PlantModel stage;
  std::vector<AtDepth> at;
};

struct Candidate {
  PiGains gains;
  Margins worst;
  double cost = std::numeric_limits<double>::infinity();
};

Known known(const PlantModel& stage) {
  Known out{stage, {}};
  for (const double depth : kDepths) {
    if (!can_hold(stage, depth) && depth > kDepths.front()) break;
    const LinearStage linear = linearised(stage, depth);
    out.at.push_back({depth, linear, response(linear)});
  }
  return out;
}

Margins margins_of(const AtDepth& stage, const PiGains& gains) {
  std::vector<std::complex<double>> loop = stage.response;
  for (std::size_t i = 0; i < loop.size(); ++i) loop[i] *= controller(gains, frequencies()[i]);
  Margins found = margins(loop);
  found.stable = holds(stage.linear, gains);
  return found;
}

// The model first, then the uncertain stages.
class Family {
 public:
  Family(const PlantModel& model, const std::vector<PlantModel>& uncertain) : stages_(uncertain.size() + 1) {
    in_parallel(stages_.size(),
                [&](std::size_t i) { stages_[i] = known(i == 0 ? model : uncertain[i - 1]); });
  }

  const PlantModel& model() const { return stages_.front().stage; }

  const std::vector<AtDepth>& depths() const { return stages_.front().at; }

  Margins worst(const PiGains& gains) const {
    std::optional<Margins> out;
    for (const Known& one : stages_)
      for (const AtDepth& at : one.at) {
        const Margins here = margins_of(at, gains);
        out = out ? worse(*out, here) : here;
      }
    return *out;
  }

  Score worst_score(const Driving& driving) const {
    Score out;
    for (const Known& one : stages_) out = worse(out, score(one.stage, driving));
    return out;
  }

 private:
  std::vector<Known> stages_;
};

// Consistent with the paper's measurement: with its gains the stage follows Fig. 9a's square wave to 0.077
// mm; draws with more than twice that are rejected. Not applied where the model itself is not consistent.
bool is_like_the_papers(const PlantModel& stage) {
  return can_hold(stage, kDepths.back()) && holds(linearised(stage, kDepths.front()), PiGains{}) &&
         score(stage, {}).settled_rmse <= 2.0 * 0.077;
}

double between(double low, double high, double share) {
  return low * std::pow(high / low, share);
}

// A grid, evenly spaced in logarithm.
std::vector<Candidate> grid(const PiGains& low, const PiGains& high, int steps) {
  std::vector<Candidate> out;
  for (int i = 0; i < steps; ++i)
    for (int j = 0; j < steps; ++j) {
      const double p = i / (steps - 1.0), q = j / (steps - 1.0);
      out.push_back({{between(low.proportional_V_per_mm, high.proportional_V_per_mm, p),
                      between(low.integral_V_per_mm_per_tick, high.integral_V_per_mm_per_tick, q)},
                     {}});
    }
  return out;
}

// Relative shortfall of the margins; 0 where they are met.
double shortfall(const Margins& m, const Requirements& wanted) {
  return std::max(0.0, 1.0 - m.gain_dB / wanted.gain_dB) +
         std::max(0.0, 1.0 - m.phase_degrees / wanted.phase_degrees) + (m.stable ? 0.0 : 1.0);
}

// Fills in the margins; keeps those that meet them, or the one that comes closest.
std::vector<Candidate> admissible(std::vector<Candidate> all, const Family& family,
                                  const TuneOptions& options) {
  const Requirements& wanted = options.wanted;
  in_parallel(all.size(), [&](std::size_t i) {
    if (!options.stop.stop_requested()) all[i].worst = family.worst(all[i].gains);
  });
  std::vector<Candidate> kept;
  for (const Candidate& c : all)
    if (c.worst.meet(wanted)) kept.push_back(c);
  if (!kept.empty()) return kept;
  return {*std::min_element(all.begin(), all.end(), [&](const Candidate& a, const Candidate& b) {
    return shortfall(a.worst, wanted) < shortfall(b.worst, wanted);
  })};
}

void sort_by_cost(std::vector<Candidate>& all) {
  std::stable_sort(all.begin(), all.end(),
                   [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
}

// Costs on the model alone, then on all stages for the best of those. The best comes first.
// Interrupted, what has no cost yet comes last.
std::vector<Candidate> ranked(std::vector<Candidate> all, const Family& family, const std::stop_token& stop) {
  in_parallel(all.size(), [&](std::size_t i) {
    if (!stop.stop_requested()) all[i].cost = score(family.model(), {all[i].gains}).cost();
  });
  sort_by_cost(all);
  if (stop.stop_requested()) return all;
  all.resize(std::min(all.size(), kBest));
  in_parallel(all.size(), [&](std::size_t i) {
    if (!stop.stop_requested()) all[i].cost = family.worst_score({all[i].gains}).cost();
  });
  sort_by_cost(all);
  return all;
}

Candidate searched(const Family& family, const TuneOptions& options, const TuneProgress& progress) {
  std::vector<Candidate> start = grid(kLeastGains, kMostGains, options.grid);
  start.push_back({PiGains{}, {}});
  Candidate best = ranked(admissible(std::move(start), family, options), family, options.stop).front();
  double spread = std::pow(kMostGains.proportional_V_per_mm / kLeastGains.proportional_V_per_mm,
                           1.0 / (options.grid - 1));
  for (int round = 0; round < kFiner && !options.stop.stop_requested(); ++round) {
    if (progress) progress(0.4 + 0.2 * round, "refining the best gains");
    const PiGains& g = best.gains;
    std::vector<Candidate> around =
        grid({std::max(g.proportional_V_per_mm / spread, kLeastGains.proportional_V_per_mm),
              std::max(g.integral_V_per_mm_per_tick / spread, kLeastGains.integral_V_per_mm_per_tick)},
             {std::min(g.proportional_V_per_mm * spread, kMostGains.proportional_V_per_mm),
              std::min(g.integral_V_per_mm_per_tick * spread, kMostGains.integral_V_per_mm_per_tick)},
             5);
    const Candidate found =
        ranked(admissible(std::move(around), family, options), family, options.stop).front();
    if (!options.stop.stop_requested() && found.cost < best.cost) best = found;
    spread = std::sqrt(spread);
  }
  return best;
}

EvaluatedGains evaluated(const Family& family, std::string name, const Driving& driving) {
  EvaluatedGains out{.name = std::move(name),
                     .gains = driving.gains,
                     .feed = driving.feed_model != nullptr,
                     .speed = driving.speed,
                     .at_depth = {},
                     .worst_margins = family.worst(driving.gains),
                     .nominal = score(family.model(), driving),
                     .worst = family.worst_score(driving)};
  for (const AtDepth& at : family.depths()) out.at_depth.push_back(margins_of(at, driving.gains));
  return out;
}

// Feed-forward with the best of a few speed limits of the target.
EvaluatedGains judged_with_feed(const Family& family, const std::string& name, const PiGains& gains) {
  std::optional<EvaluatedGains> best;
  for (const double speed : kSpeeds) {
    EvaluatedGains here = evaluated(family, name, {gains, &family.model(), speed});
    if (!best || here.worst.cost() < best->worst.cost()) best = std::move(here);
  }
  return *best;
}

// The paper's gains times a half to two, each.
std::vector<Candidate> near_the_papers() {
  constexpr int kSteps = 7;
  const PiGains paper{};
  return grid({paper.proportional_V_per_mm / 2.0, paper.integral_V_per_mm_per_tick / 2.0},
              {paper.proportional_V_per_mm * 2.0, paper.integral_V_per_mm_per_tick * 2.0}, kSteps);
}

// Of the gains near the paper's that improve on them, those whose largest gain is largest.
std::optional<EvaluatedGains> improved(const Family& family, const EvaluatedGains& paper,
                                       const std::stop_token& stop) {
  const std::vector<Candidate> all = near_the_papers();
  std::vector<double> gains(all.size(), 0.0);
  in_parallel(all.size(), [&](std::size_t i) {
    if (stop.stop_requested()) return;
    EvaluatedGains here = paper;  // on the worst stage not yet evaluated: as the paper's
    here.worst_margins = family.worst(all[i].gains);
    here.nominal = score(family.model(), {all[i].gains});
    std::vector<Respect> seen = respects(paper, here);
    if (!improves(seen)) return;
    here.worst = family.worst_score({all[i].gains});
    seen = respects(paper, here);
    if (improves(seen)) gains[i] = std::ranges::max(seen, {}, [](const Respect& r) { return r.gain; }).gain;
  });
  const auto best = static_cast<std::size_t>(std::ranges::max_element(gains) - gains.begin());
  if (gains[best] <= 0.0 || stop.stop_requested()) return {};
  return evaluated(family, "improved gains", {all[best].gains});
}

}  // namespace

Tuning tune(const NotedModel& given, const TuneOptions& options, const TuneProgress& progress) {
  if (given.model.baseline.drive != Drive::Stack)
    throw ConfigError("a stage that is driven by a force has no voltage to tune", "drive = \"force\"",
                      "give the model of a needle stage");
  if (progress) progress(0.0, "drawing uncertain stages");
  NotedModel model = given;
  model.model.weight = paper::kWeight;
  const IsPlausible is_plausible =
      is_like_the_papers(model.model) ? IsPlausible(is_like_the_papers) : IsPlausible();
  UncertainStages uncertain = uncertain_stages(model, options.stages, options.seed, is_plausible);
  if (options.stop.stop_requested()) uncertain.stages.clear();  // the model alone is evaluated in time
  const Family family(model.model, uncertain.stages);
  if (progress) progress(0.1, "searching gains with the required margins");
  const Candidate best = searched(family, options, progress);
  if (progress) progress(0.8, "evaluating");
  Tuning out;
  for (const AtDepth& at : family.depths()) out.depths.push_back(at.depth);
  out.varied = uncertain.varied;
  out.assumed = uncertain.assumed;
  out.refused = uncertain.refused;
  out.stages = static_cast<int>(uncertain.stages.size());
  out.correlated = !uncertain.assumed && given.notes.correlations.has_value();
  out.wanted = options.wanted;
  out.met = best.worst.meet(options.wanted);
  out.interrupted = options.stop.stop_requested();
  out.evaluated.resize(out.interrupted ? 2 : 4);
  in_parallel(out.evaluated.size(), [&](std::size_t i) {
    const PiGains gains = i % 2 == 0 ? PiGains{} : best.gains;
    const std::string name = i % 2 == 0 ? "paper's gains" : "tuned gains";
    out.evaluated[i] =
        i < 2 ? evaluated(family, name, {gains}) : judged_with_feed(family, name + ", feed-forward", gains);
  });
  if (progress) progress(0.9, "looking near the paper's gains");
  out.improved = improved(family, out.evaluated.front(), options.stop);
  out.panels = tuning_panels(model.model, out);
  return out;
}

}  // namespace biopsy::sim::tuning
