#include "sim/gap/fit/probes.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string_view>

namespace biopsy::sim::gap {
namespace {

constexpr std::size_t kPeaks = 3;
constexpr double kLowestFrequency = 0.05, kHighestFrequency = 15.0;  // Hz: breathing to pumps
constexpr double kSpectrumRate = 60.0;                               // Hz, residual thinned to
constexpr double kFewestPeriods = 3.0, kHarmonics = 4.0;             // of a motion that repeats itself
constexpr double kRepeats = 0.5;                                     // of its variance in one line,
constexpr double kPartOfLine = 0.5;                                  // the line's width being 1/length
constexpr std::array kPlaces{0.1, 0.35, 0.6, 0.85, 0.96};  // of the range that was measured; a stop ends it
// Where a surface gives way once, the cost has a minimum for each rise that may be the one.
constexpr std::array kFinePlaces{0.04, 0.12, 0.2, 0.28, 0.36, 0.44, 0.52, 0.6, 0.7, 0.85};
constexpr std::array kFineFactors{1.0, 0.5, 2.0};
constexpr std::array kLevels{0.95, 0.85, 0.7, 0.5};  // of the largest voltage
constexpr std::array kShapeFactors{1.0, 0.2, 5.0};
constexpr double kUsualStroke = 4e-3;  // m, of a stage, for which the library's typical lengths are
constexpr double kUsualSize = 3.0;     // times as much or little, within which they stay
constexpr std::string_view kLength = "_mm";

using Starts = std::vector<std::vector<double>>;

struct ThinRun {
  std::vector<double> time, value;
};

// One value for each training row.
std::vector<ThinRun> thinned(const std::vector<double>& values, const Evidence& evidence) {
  std::vector<ThinRun> out;
  std::size_t at = 0;
  for (const EvidenceRun& run : evidence.runs) {
    ThinRun thin;
    double next = 0.0, mean = 0.0;
    for (std::size_t i = 0; i < run.training_rows; ++i, ++at) {
      if (run.rows[i].time < next) continue;
      thin.time.push_back(run.rows[i].time);
      thin.value.push_back(values[at]);
      mean += values[at];
      next += 1.0 / kSpectrumRate;
    }
    for (double& value : thin.value) value -= mean / static_cast<double>(thin.value.size());
    if (!thin.time.empty()) out.push_back(std::move(thin));
  }
  return out;
}

double power(const ThinRun& run, double frequency) {
  std::complex<double> sum = 0.0;
  for (std::size_t i = 0; i < run.time.size(); ++i)
    sum += run.value[i] * std::polar(1.0, -2.0 * std::numbers::pi * frequency * run.time[i]);
  return std::norm(sum) / static_cast<double>(run.time.size());
}

// Frequency with which a run's motion repeats itself, Hz; 0 where it does not, or only a few times.
double repetition(const ThinRun& run) {
  const double length = run.time.back() - run.time.front();
  double square = 0.0, most = 0.0, at = 0.0;
  for (const double value : run.value) square += value * value;
  for (double f = kFewestPeriods / length; f < kHighestFrequency; f += kPartOfLine / length)
    if (const double here = power(run, f); here > most) most = here, at = f;
  return 2.0 * most > kRepeats * square ? at : 0.0;
}

// Whether every run's motion repeats itself at a fraction of that frequency: so do all errors of a model.
bool goes_with_motion(double frequency, const std::vector<ThinRun>& motion,
                      const std::vector<double>& repetitions) {
  for (std::size_t i = 0; i < motion.size(); ++i) {
    if (repetitions[i] == 0.0) return false;
    const double n = std::round(frequency / repetitions[i]);
    const double line = kPartOfLine * n / (motion[i].time.back() - motion[i].time.front());
    if (n < 1.0 || n > kHarmonics || std::abs(frequency - n * repetitions[i]) > line) return false;
  }
  return true;
}

// What the model says of the training rows.
std::vector<double> predicted(const std::vector<double>& training_residual, const Evidence& evidence) {
  std::vector<double> out;
  for (const EvidenceRun& run : evidence.runs)
    for (std::size_t i = 0; i < run.training_rows; ++i)
      out.push_back(run.rows[i].measured - training_residual[out.size()]);
  return out;
}

// Replaces every vector by one for each value of parameter i.
template <class Values>
void vary(Starts& starts, std::size_t i, const Values& values) {
  Starts out;
  for (const auto& start : starts)
    for (const double value : values) {
      out.push_back(start);
      out.back()[i] = value;
    }
  starts = std::move(out);
}

// A shape between two forms, not a size.
bool is_mixture(const LibraryParameter& p) {
  return p.low == 0.0 && p.high == 1.0;
}

// Of the library's typical lengths: a mechanism may move by a hundred times as much as a stage.
double size_of_motion(const Evidence& evidence) {
  const double size = (evidence.x_high - evidence.x_low) / kUsualStroke;
  return size > kUsualSize || (size > 0.0 && size * kUsualSize < 1.0) ? size : 1.0;
}

std::vector<double> shapes_of(const LibraryParameter& p, bool fine, const Evidence& evidence) {
  if (is_mixture(p)) return {p.typical, 0.5 * (p.low + p.high)};
  if (p.low <= 0.0) return {p.typical, p.high};
  const double typical = p.typical * (p.name.ends_with(kLength) ? size_of_motion(evidence) : 1.0);
  std::vector<double> out;
  out.reserve(kShapeFactors.size());
  for (const double factor : fine ? kFineFactors : kShapeFactors)
    out.push_back(std::clamp(typical * factor, p.low, p.high));
  return out;
}

std::vector<double> scaled(const auto& shares, double from, double to) {
  std::vector<double> out;
  out.reserve(shares.size());
  for (const double share : shares) out.push_back(from + share * (to - from));
  return out;
}

// Along the range of the motion; of a place that counts in either direction the distance.
std::vector<double> places(const LibraryParameter& p, const Evidence& evidence) {
  std::vector<double> out = scaled(kPlaces, evidence.x_low, evidence.x_high);
  if (p.low >= 0.0)
    for (double& place : out) place = std::abs(place);
  return out;
}

// All strengths together, and each alone where there are several.
Starts strength_sets(const LibraryEffect& effect, bool each_alone) {
  std::vector<double> typical;
  std::vector<std::size_t> strengths;
  for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
    const LibraryParameter& p = effect.parameters[i];
    double value = p.typical;
    if (p.role == Role::Strength && value == 0.0) value = 1e-3 * p.high;
    typical.push_back(value);
    if (p.role == Role::Strength) strengths.push_back(i);
  }
  Starts out{typical};
  if (turns_with_sign(effect)) {
    out.push_back(typical);
    for (const std::size_t i : strengths) out.back()[i] *= -1.0;
  }
  if (!each_alone || strengths.size() < 2) return out;
  for (const std::size_t kept : strengths) {
    out.push_back(typical);
    for (const std::size_t i : strengths)
      if (i != kept) out.back()[i] = 0.0;
  }
  return out;
}

}  // namespace

Spectrum residual_spectrum(const std::vector<double>& training_residual, const Evidence& evidence) {
  const std::vector<ThinRun> runs = thinned(training_residual, evidence);
  double longest = 0.0, shortest_step = 1.0 / kSpectrumRate;
  for (const ThinRun& run : runs) {
    longest = std::max(longest, run.time.back() - run.time.front());
    if (run.time.size() > 1)
      shortest_step = std::max(shortest_step, longest / static_cast<double>(run.time.size()));
  }
  const double step = 0.5 / std::max(longest, 1.0),
               highest = std::min(kHighestFrequency, 0.4 / shortest_step);
  std::vector<std::pair<double, double>> lines;  // power, frequency
  for (double f = std::max(kLowestFrequency, 2.0 * step); f < highest; f += step) {
    double sum = 0.0;
    for (const ThinRun& run : runs) sum += power(run, f);
    lines.emplace_back(sum, f);
  }
  std::vector<std::pair<double, double>> peaks;
  for (std::size_t i = 1; i + 1 < lines.size(); ++i)
    if (lines[i].first >= lines[i - 1].first && lines[i].first > lines[i + 1].first)
      peaks.push_back(lines[i]);
  std::sort(peaks.rbegin(), peaks.rend());
  const std::vector<ThinRun> motion = thinned(predicted(training_residual, evidence), evidence);
  std::vector<double> repetitions;
  repetitions.reserve(motion.size());
  for (const ThinRun& run : motion) repetitions.push_back(repetition(run));
  std::erase_if(peaks, [&](const auto& peak) { return goes_with_motion(peak.second, motion, repetitions); });
  Spectrum out;
  for (std::size_t i = 0; i < std::min(kPeaks, peaks.size()); ++i) out.peaks.push_back(peaks[i].second);
  return out;
}

bool acts_on(const LibraryEffect& effect, Drive drive) {
  if (drive == Drive::Stack) return true;
  const bool above_plate_a =
      effect.info.attaches == Attachment::Electrical || effect.info.attaches == Attachment::Pouch;
  return !above_plate_a && effect.info.name != "added_mass";  // there it is the number m
}

bool gives_way(const LibraryEffect& effect) {
  return effect.info.name == LayerPuncture::info.name;
}

bool turns_with_sign(const LibraryEffect& effect) {
  return effect.info.name == DirectionalDamping::info.name;
}

std::vector<std::vector<double>> probe_starts(int effect, const Evidence& evidence,
                                              const Spectrum& spectrum) {
  const LibraryEffect& probed = library_effect(effect);
  const bool placed = std::any_of(probed.parameters.begin(), probed.parameters.end(),
                                  [](const LibraryParameter& p) { return p.role == Role::Place; });
  const bool fine = gives_way(probed);
  Starts starts = strength_sets(probed, !placed);
  bool shaped = false;
  for (std::size_t i = 0; i < probed.parameters.size(); ++i) {
    const LibraryParameter& p = probed.parameters[i];
    switch (p.role) {
      case Role::Strength:
        break;
      case Role::Shape:
        if (!shaped || is_mixture(p)) vary(starts, i, shapes_of(p, fine, evidence));
        shaped = shaped || !is_mixture(p);
        break;
      case Role::Place:
        if (fine)
          vary(starts, i, scaled(kFinePlaces, evidence.x_low, evidence.x_high));
        else
          vary(starts, i, places(p, evidence));
        break;
      case Role::Level:
        vary(starts, i, scaled(kLevels, 0.0, evidence.u_max));
        break;
      case Role::Frequency:
        vary(starts, i, spectrum.peaks);
        break;
      case Role::Phase:
        break;
    }
  }
  return starts;
}

}  // namespace biopsy::sim::gap
