#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "robot/common/statistics.hpp"
#include "sim/gap/examine/examine.hpp"
#include "sim/gap/millimetres.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kMoves = 10.0;          // noises
constexpr std::size_t kFrozenRows = 30;  // of one value, where readings otherwise change
constexpr double kFrozenSeconds = 0.3;
constexpr std::size_t kFewFrozen = 5;    // spells: more of them are dry friction without sensor noise
constexpr double kChanging = 0.8;        // share of rows outside spells that differ from the row before
constexpr double kJump = 5.0;            // usual steps, after a frozen reading
constexpr std::size_t kClippedRows = 5;  // of one spell at the extreme value
constexpr double kOutlier = 30.0;        // scatters of the readings against their neighbours' median
constexpr double kOutlierRange = 0.02;   // of the range, that an outlier stands apart at least
constexpr double kOutlierShare = 0.01;   // of all rows; more is no outlier
constexpr double kOnGrid = 1e-3;         // of a step
constexpr double kCoarse = 1.5;          // noises a step must have to matter
constexpr std::size_t kFewestLevels = 3, kMostLevels = 20000;
constexpr double kPast = 5.0;    // levels of a coarse sensor that a motion must have led past a value
constexpr double kWeaker = 0.8;  // of the input that moves plate A: what may not
constexpr std::size_t kRowsOfALevel = 4;  // at least, of a coarse sensor
constexpr double kMarkApart = 3.0;        // ranges of all other readings

// Rows [from, to) of one value.
struct Spell {
  std::size_t from = 0, to = 0;
  std::size_t rows() const { return to - from; }
};

std::vector<Spell> spells_of(const std::vector<double>& x, std::size_t fewest) {
  std::vector<Spell> out;
  for (std::size_t i = 0; i < x.size();) {
    std::size_t end = i + 1;
    while (end < x.size() && x[end] == x[i]) ++end;
    if (end - i >= fewest) out.push_back({i, end});
    i = end;
  }
  return out;
}

// Share of the rows outside `spells` that differ from the row before: 1 where sensor noise is visible.
double changing_share(const std::vector<double>& x, const std::vector<Spell>& spells) {
  std::size_t changes = 0, inside = 0;
  for (std::size_t i = 1; i < x.size(); ++i) changes += x[i] != x[i - 1];
  for (const Spell& spell : spells) inside += spell.rows() - 1;
  const std::size_t outside = x.size() - 1 - inside;
  return outside == 0 ? 0.0 : static_cast<double>(changes) / static_cast<double>(outside);
}

double usual_step(const std::vector<double>& x) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < x.size(); ++i)
    if (x[i] != x[i - 1]) steps.push_back(std::abs(x[i] - x[i - 1]));
  return median(std::move(steps));
}

std::vector<double> levels_of(std::vector<double> x) {
  std::ranges::sort(x);
  x.erase(std::unique(x.begin(), x.end()), x.end());
  return x;
}

// Distance of the values that a coarse sensor can give, m; 0 where readings do not repeat. As the file's
// digits round them, so they need not be multiples.
double level_spacing(const std::vector<double>& x) {
  const std::vector<double> levels = levels_of(x);
  if (levels.size() < kFewestLevels || kRowsOfALevel * levels.size() > x.size()) return 0.0;
  return usual_step(levels);
}

// A coarse sensor repeats a reading at the end of a motion and at rest too; but then the motion slows down
// before. Whether the readings before a spell lead past its value, in the two rows that follow.
bool cut_short(const std::vector<double>& x, const Spell& spell, double spacing) {
  if (spacing == 0.0) return true;
  if (spell.from < 3) return false;
  const double moved = x[spell.from - 1] - x[spell.from - 3];
  return (x[spell.from - 1] + moved - x[spell.from]) * (moved < 0.0 ? -1.0 : 1.0) > kPast * spacing;
}

// A sensor that fails jumps to its last value; a motion runs into the end of a range in steps like those
// before.
bool jumps_into(const std::vector<double>& x, const Spell& spell, double step) {
  if (spell.from < 2) return false;
  const double into = std::abs(x[spell.from] - x[spell.from - 1]);
  return into > kJump * std::max(step, std::abs(x[spell.from - 1] - x[spell.from - 2]));
}

struct Channels {
  const Dataset& dataset;
  const RecordedRun& run;
  std::string input;  // its column
  double noise = 0.0;
};

using Found = std::optional<DataRemark>;

double largest_size(const std::vector<double>& values) {
  return std::max(std::ranges::max(values), -std::ranges::min(values));
}

// Dry friction holds plate A where less drives it than in each run in which it moves. Its reading stands
// still then if the sensor has steps; one without would scatter.
bool may_be_held(const Channels& c) {
  bool any_moves = false;
  for (const RecordedRun& other : c.dataset.runs) {
    if (range_of(other.displacement) == 0.0) continue;
    any_moves = true;
    if (level_spacing(other.displacement) == 0.0 ||
        largest_size(c.run.input) > kWeaker * largest_size(other.input))
      return false;
  }
  return any_moves;
}

Found constant(const Channels& c) {
  const RecordedRun& run = c.run;
  const bool same_input = range_of(run.input) == 0.0, same_reading = range_of(run.displacement) == 0.0;
  const bool at_rest = same_input && run.input.front() == 0.0;
  if (same_reading && !at_rest && may_be_held(c))
    return DataRemark{
        "no_motion",
        "displacement_mm",
        {run.name},
        false,
        fmt::format("The displacement is {:.4g} mm throughout, and less drives plate A than in the "
                    "runs in which it moves: friction may hold it. If the sensor was dead, leave "
                    "the run out.",
                    kMm * run.displacement.front())};
  if (same_reading && !at_rest)
    return DataRemark{
        "constant",
        "displacement_mm",
        {run.name},
        true,
        fmt::format("The displacement is {:.4g} mm throughout, {}: the sensor is dead, or another "
                    "column is the displacement. Give the column in dataset.toml, [columns] "
                    "displacement, or leave the run out.",
                    kMm * run.displacement.front(),
                    same_input ? fmt::format("and {} is {:.4g}", c.input, run.input.front())
                               : fmt::format("while {} changes", c.input))};
  if (at_rest && range_of(run.displacement) > kMoves * c.noise)
    return DataRemark{
        "constant",
        c.input,
        {run.name},
        true,
        fmt::format("{} is 0 throughout, while plate A moves by {:.3g} mm: the input was not "
                    "recorded. Give its column in dataset.toml, [columns], or leave the run out.",
                    c.input, kMm * range_of(run.displacement))};
  return {};
}

// Whether all readings of this value are the last ones.
bool lasts(const std::vector<double>& x, double value, std::size_t rows) {
  return std::all_of(x.end() - static_cast<std::ptrdiff_t>(rows), x.end(),
                     [value](double reading) { return reading == value; });
}

// One value far from where all others lie: -999 for a reading that failed. 0 is a place as well, and a sensor
// that stays at its end from then on is frozen.
Found missing(const Channels& c) {
  const std::vector<double>& x = c.run.displacement;
  const std::vector<double> levels = levels_of(x);
  if (levels.size() < kFewestLevels) return {};
  const std::size_t last = levels.size() - 1;
  for (const std::size_t at : {std::size_t{0}, last}) {
    const double low = levels[at == 0 ? 1 : 0], high = levels[at == 0 ? last : last - 1];
    const double apart = at == 0 ? low - levels[at] : levels[at] - high;
    const auto rows = static_cast<std::size_t>(std::ranges::count(x, levels[at]));
    if (rows < 2 || 2 * rows > x.size() || apart <= kMarkApart * (high - low)) continue;
    if (levels[at] == 0.0 || lasts(x, levels[at], rows)) continue;
    return DataRemark{
        "missing",
        "displacement_mm",
        {c.run.name},
        true,
        fmt::format("{} readings are exactly {:.6g} mm, while all others lie between {:.4g} and {:.4g} mm: a "
                    "mark for a reading that is missing. Remove these rows and write `resample = true` in "
                    "dataset.toml; where many follow each other, split the run there.",
                    rows, kMm * levels[at], kMm * low, kMm * high)};
  }
  return {};
}

// A reading that stands while all others scatter, and jumps where it goes on.
Found frozen(const Channels& c) {
  const std::vector<double>& x = c.run.displacement;
  const auto fewest = std::max(kFrozenRows, static_cast<std::size_t>(kFrozenSeconds / c.run.period));
  const std::vector<Spell> spells = spells_of(x, fewest);
  if (spells.empty() || spells.size() > kFewFrozen || changing_share(x, spells) < kChanging) return {};
  const double step = usual_step(x), low = std::ranges::min(x), high = std::ranges::max(x);
  const double spacing = level_spacing(x);
  for (const Spell& spell : spells) {
    const bool extreme = x[spell.from] == low || x[spell.from] == high;
    if (extreme && !jumps_into(x, spell, step)) continue;  // clipped, or at rest without noise
    const bool jumps = spell.to < x.size() && std::abs(x[spell.to] - x[spell.from]) > kJump * step;
    if ((!jumps && spell.to < x.size()) || !cut_short(x, spell, spacing)) continue;
    return DataRemark{"frozen",
                      "displacement_mm",
                      {c.run.name},
                      true,
                      fmt::format("The displacement stands at exactly {:.4g} mm from {:.4g} s to {:.4g} s, "
                                  "while its other readings scatter: readings were repeated, or another "
                                  "column is the displacement. Leave this part or the run out, or give the "
                                  "column in dataset.toml, [columns] displacement.",
                                  kMm * x[spell.from], c.run.time[spell.from], c.run.time[spell.to - 1])};
  }
  return {};
}

// Readings that stop at one value in the middle of a motion.
Found clipped(const Channels& c) {
  const std::vector<double>& x = c.run.displacement;
  const std::vector<Spell> spells = spells_of(x, kClippedRows);
  std::size_t standing = 0;
  for (const Spell& spell : spells) standing += spell.rows();
  if (2 * standing > x.size() || changing_share(x, spells) < kChanging) return {};
  const double step = usual_step(x), spacing = level_spacing(x);
  for (const double limit : {std::ranges::max(x), std::ranges::min(x)}) {
    std::size_t rows = 0, abrupt = 0;
    for (const Spell& spell : spells) {
      if (x[spell.from] != limit || jumps_into(x, spell, step)) continue;
      rows += spell.rows();
      const bool arrives = spell.from >= 3 && std::abs(x[spell.from - 3] - limit) > 2.0 * step;
      // At the beginning it is at rest until it is driven.
      const bool leaves =
          spell.from > 0 && spell.to + 2 < x.size() && std::abs(x[spell.to + 2] - limit) > 2.0 * step;
      abrupt += (arrives || leaves) && cut_short(x, spell, spacing) ? 1 : 0;
    }
    if (rows < 2 * kClippedRows || abrupt == 0) continue;
    return DataRemark{"clipped",
                      "displacement_mm",
                      {c.run.name},
                      true,
                      fmt::format("{} readings are exactly {:.4g} mm, the {} value, reached and left in the "
                                  "middle of a motion: the sensor's range is exceeded. Record with a larger "
                                  "range, or leave the run out.",
                                  rows, kMm * limit, limit == std::ranges::max(x) ? "largest" : "smallest")};
  }
  return {};
}

Found quantised(const Channels& c) {
  const double step = quantisation_step(c.run.displacement);
  if (step < kCoarse * c.noise) return {};
  return DataRemark{"quantised",
                    "displacement_mm",
                    {c.run.name},
                    false,
                    fmt::format("The displacement is quantised in steps of {:.3g} mm: what is smaller than "
                                "{:.2g} mm is not resolved and counts as noise.",
                                kMm * step, kMm * step / std::sqrt(12.0))};
}

Found outliers(const Channels& c) {
  const std::vector<double>& x = c.run.displacement;
  std::vector<double> off(x.size(), 0.0);
  // A peak of a fast motion stands out of the median too, but not of a curve through its neighbours; the last
  // reading before plate A bounces off a stop not of the motion before it.
  for (std::size_t i = 2; i + 2 < x.size(); ++i) {
    const double curve = (4.0 * (x[i - 1] + x[i + 1]) - (x[i - 2] + x[i + 2])) / 6.0;
    const double middle = median(std::vector<double>{x[i - 2], x[i - 1], x[i], x[i + 1], x[i + 2]});
    off[i] = std::abs(x[i] - middle);
    for (const double expected : {curve, 2.0 * x[i - 1] - x[i - 2], 2.0 * x[i + 1] - x[i + 2]})
      off[i] = std::min(off[i], std::abs(x[i] - expected));
  }
  const double scatter = std::max({c.noise, kMadToSigma * median(off), quantile(off, 0.99) / 5.0,
                                   kOutlierRange * range_of(x) / kOutlier});
  const auto count = std::ranges::count_if(off, [&](double d) { return d > kOutlier * scatter; });
  if (count == 0 || static_cast<double>(count) > kOutlierShare * static_cast<double>(x.size())) return {};
  const auto at = static_cast<std::size_t>(std::ranges::max_element(off) - off.begin());
  return DataRemark{
      "outliers",
      "displacement_mm",
      {c.run.name},
      true,
      fmt::format("{} single readings stand apart from their neighbours, the first by up to {:.3g} "
                  "mm at {:.4g} s: remove these rows and write `resample = true` in dataset.toml.",
                  count, kMm * off[at], c.run.time[at])};
}

void add_copies(std::vector<DataRemark>& out, const Dataset& dataset) {
  for (std::size_t i = 0; i < dataset.runs.size(); ++i)
    for (std::size_t j = i + 1; j < dataset.runs.size(); ++j) {
      const RecordedRun &a = dataset.runs[i], &b = dataset.runs[j];
      if (a.displacement != b.displacement || range_of(a.displacement) == 0.0) continue;
      const bool same = a.input == b.input;
      out.push_back(
          {"copied",
           "displacement_mm",
           {a.name, b.name},
           true,
           fmt::format("Runs {} and {} hold the same displacement, reading by reading, with {}: one "
                       "is a copy of the other. Leave one out, or give its own file.",
                       a.name, b.name, same ? "the same input" : "different inputs")});
    }
}

void add_to(std::vector<DataRemark>& out, DataRemark remark) {
  const auto same = std::ranges::find_if(
      out, [&](const DataRemark& one) { return one.cause == remark.cause && one.channel == remark.channel; });
  if (same == out.end())
    out.push_back(std::move(remark));
  else
    same->runs.push_back(remark.runs.front());
}

}  // namespace

double quantisation_step(const std::vector<double>& readings) {
  const std::vector<double> levels = levels_of(readings);
  if (levels.size() < kFewestLevels || levels.size() > kMostLevels ||
      kRowsOfALevel * levels.size() > readings.size())
    return 0.0;
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < levels.size(); ++i) step = std::min(step, levels[i] - levels[i - 1]);
  for (const double level : levels) {
    const double steps = (level - levels.front()) / step;
    if (std::abs(steps - std::round(steps)) > std::max(kOnGrid, 1e-6 * steps)) return 0.0;
  }
  return step;
}

std::string run_list(const std::vector<std::string>& runs, std::size_t of) {
  if (runs.size() == of && of > 1) return "all runs";
  return fmt::format("run{} {}", runs.size() == 1 ? "" : "s", fmt::join(runs, ", "));
}

std::vector<DataRemark> examine_channels(const Dataset& dataset, Drive drive, double noise) {
  std::vector<DataRemark> out;
  add_copies(out, dataset);
  for (const RecordedRun& run : dataset.runs) {
    const Channels channels{dataset, run, drive == Drive::Force ? "force_N" : "voltage_V", noise};
    for (const auto check : {constant, missing, frozen, clipped, quantised, outliers})
      if (Found found = check(channels)) {
        add_to(out, std::move(*found));
        if (is_unusable(out.back())) break;
      }
  }
  return out;
}

}  // namespace biopsy::sim::gap
