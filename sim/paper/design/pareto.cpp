#include "sim/paper/design/pareto.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "robot/common/in_parallel.hpp"
#include "sim/plant/seeded_noise.hpp"

namespace biopsy::sim::design {
namespace {

constexpr std::size_t kChoices = 6;
using Genes = std::array<double, kChoices>;  // each in [0, 1]

struct Range {
  double StackDesign::*member;
  double low, high;
  bool logarithmic;
};

// Around what the paper built and what its amplifier may give (safety/types/limits.hpp: 8 kV).
constexpr std::array<Range, kChoices> kRanges{{{&StackDesign::oil_mL, 1.0, 8.0, true},
                                               {&StackDesign::side_mm, 40.0, 80.0, false},
                                               {&StackDesign::film_um, 25.0, 125.0, true},
                                               {&StackDesign::pouches, 4.0, 20.0, false},
                                               {&StackDesign::spring_N_per_mm, 0.06, 1.0, true},
                                               {&StackDesign::drive_kV, 3.0, 8.0, false}}};
constexpr std::array kFilmsSold{25.0, 50.0, 75.0, 125.0};  // um

StackDesign decoded(const Genes& genes) {
  StackDesign design;
  for (std::size_t i = 0; i < kChoices; ++i) {
    const Range& r = kRanges[i];
    design.*r.member =
        r.logarithmic ? r.low * std::pow(r.high / r.low, genes[i]) : r.low + genes[i] * (r.high - r.low);
  }
  design.pouches = std::round(design.pouches);
  design.film_um = *std::min_element(kFilmsSold.begin(), kFilmsSold.end(), [&](double a, double b) {
    return std::abs(std::log(a / design.film_um)) < std::abs(std::log(b / design.film_um));
  });
  return design;
}

Genes encoded(const StackDesign& design) {
  Genes genes{};
  for (std::size_t i = 0; i < kChoices; ++i) {
    const Range& r = kRanges[i];
    const double value = design.*r.member;
    genes[i] = r.logarithmic ? std::log(value / r.low) / std::log(r.high / r.low)
                             : (value - r.low) / (r.high - r.low);
    genes[i] = std::clamp(genes[i], 0.0, 1.0);
  }
  return genes;
}

constexpr double kSameBandwidth = 0.05;  // of ln f: too small a difference to choose a stack by

// The smaller the better, all five.
std::array<double, 5> objectives(const DesignedStack& s) {
  const StackFigures& f = s.figures;
  const double bandwidth = std::round(std::log(f.bandwidth_Hz) / kSameBandwidth);
  return {-f.stroke_mm, f.ripple_mm, -bandwidth, -f.breakdown_margin, f.height_mm};
}

// Numbers of its own for every use: order of work plays no part.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : seed_(seed) {}
  double share() { return uniform(seed_, used_++); }
  std::size_t below(std::size_t n) {
    return std::min(n - 1, static_cast<std::size_t>(share() * static_cast<double>(n)));
  }

 private:
  std::uint64_t seed_, used_ = 0;
};

// One value in each of `count` equal slices of every choice.
std::vector<Genes> latin_hypercube(std::size_t count, Dice& dice) {
  std::vector<Genes> genes(count);
  for (std::size_t choice = 0; choice < kChoices; ++choice) {
    std::vector<std::size_t> slice(count);
    std::iota(slice.begin(), slice.end(), 0);
    for (std::size_t i = count; i > 1; --i) std::swap(slice[i - 1], slice[dice.below(i)]);
    for (std::size_t i = 0; i < count; ++i)
      genes[i][choice] = (static_cast<double>(slice[i]) + dice.share()) / static_cast<double>(count);
  }
  return genes;
}

// A parent moved by the difference of two others; what leaves the range comes back in.
Genes varied(const std::vector<Genes>& parents, std::size_t i, Dice& dice) {
  const Genes &a = parents[dice.below(parents.size())], &b = parents[dice.below(parents.size())];
  const double far = 0.3 + 0.6 * dice.share();
  Genes child = parents[i];
  for (std::size_t c = 0; c < kChoices; ++c) {
    if (dice.share() < 0.6) child[c] += far * (a[c] - b[c]);
    if (dice.share() < 0.1) child[c] = dice.share();
    if (child[c] < 0.0) child[c] = -child[c];
    if (child[c] > 1.0) child[c] = 2.0 - child[c];
    child[c] = std::clamp(child[c], 0.0, 1.0);
  }
  return child;
}

struct Individual {
  Genes genes;
  DesignedStack stack;
  std::size_t rank = 0;
  double spacing = 0.0;  // to its neighbours of the same rank
};

// Rank: how many rounds of taking away the unbeaten it survives.
void rank(std::vector<Individual>& all) {
  std::vector<std::size_t> left(all.size());
  std::iota(left.begin(), left.end(), 0);
  for (std::size_t round = 0; !left.empty(); ++round) {
    std::vector<std::size_t> beaten;
    for (const std::size_t i : left) {
      const bool lost = std::any_of(left.begin(), left.end(),
                                    [&](std::size_t j) { return beats(all[j].stack, all[i].stack); });
      if (lost)
        beaten.push_back(i);
      else
        all[i].rank = round;
    }
    left = std::move(beaten);
  }
}

void measure_room(std::vector<Individual>& all) {
  std::vector<std::size_t> order(all.size());
  for (Individual& one : all) one.spacing = 0.0;
  for (std::size_t objective = 0; objective < 5; ++objective) {
    std::iota(order.begin(), order.end(), 0);
    const auto value = [&](std::size_t i) { return objectives(all[i].stack)[objective]; };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return std::tuple(all[a].rank, value(a), a) < std::tuple(all[b].rank, value(b), b);
    });
    const double range = std::max(1e-12, std::abs(value(order.back()) - value(order.front())));
    for (std::size_t k = 0; k < order.size(); ++k) {
      const bool edge = k == 0 || k + 1 == order.size() || all[order[k - 1]].rank != all[order[k]].rank ||
                        all[order[k + 1]].rank != all[order[k]].rank;
      all[order[k]].spacing += edge ? std::numeric_limits<double>::infinity()
                                    : (value(order[k + 1]) - value(order[k - 1])) / range;
    }
  }
}

void keep_best(std::vector<Individual>& all, std::size_t count) {
  rank(all);
  measure_room(all);
  std::stable_sort(all.begin(), all.end(), [](const Individual& a, const Individual& b) {
    return a.rank != b.rank ? a.rank < b.rank : a.spacing > b.spacing;
  });
  all.resize(std::min(count, all.size()));
}

}  // namespace

bool beats(const DesignedStack& a, const DesignedStack& b) {
  if (a.shortfall > 0.0 || b.shortfall > 0.0) return a.shortfall < b.shortfall;
  const auto x = objectives(a), y = objectives(b);
  bool better = false;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (x[i] > y[i]) return false;
    better = better || x[i] < y[i];
  }
  return better;
}

std::vector<DesignedStack> unbeaten(const std::vector<DesignedStack>& stacks) {
  std::vector<DesignedStack> best;
  for (std::size_t i = 0; i < stacks.size(); ++i) {
    bool lost = false;
    for (std::size_t j = 0; j < stacks.size() && !lost; ++j)
      lost = beats(stacks[j], stacks[i]) || (j < i && objectives(stacks[j]) == objectives(stacks[i]));
    if (!lost) best.push_back(stacks[i]);
  }
  return best;
}

std::vector<DesignedStack> search(const DesignedStack& start, const Evaluate& evaluate,
                                  const SearchSize& size, const Progress& progress) {
  Dice dice(size.seed);
  std::vector<DesignedStack> seen{start};
  std::vector<Individual> kept;
  for (std::size_t generation = 0; generation <= size.generations; ++generation) {
    std::vector<Genes> genes;
    if (generation == 0) {
      genes = latin_hypercube(size.population, dice);
      genes.front() = encoded(start.design);
    } else {
      std::vector<Genes> parents;
      parents.reserve(kept.size());
      for (const Individual& one : kept) parents.push_back(one.genes);
      for (std::size_t i = 0; i < parents.size(); ++i) genes.push_back(varied(parents, i, dice));
    }
    std::vector<Individual> young(genes.size());
    in_parallel(genes.size(), [&](std::size_t i) {
      if (!size.stop.stop_requested()) young[i] = {genes[i], evaluate(decoded(genes[i])), 0, 0.0};
    });
    if (size.stop.stop_requested()) break;
    for (const Individual& one : young) seen.push_back(one.stack);
    kept.insert(kept.end(), young.begin(), young.end());
    keep_best(kept, size.population);
    if (progress) progress(static_cast<double>(generation + 1) / static_cast<double>(size.generations + 1));
  }
  return seen;
}

}  // namespace biopsy::sim::design
