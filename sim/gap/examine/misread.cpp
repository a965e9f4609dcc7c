#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "robot/common/in_parallel.hpp"
#include "robot/common/statistics.hpp"
#include "sim/gap/examine/examine.hpp"
#include "sim/gap/residual/predict.hpp"
#include "sim/plant/plant.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kMisses = 0.3;        // misfit from which a run may be misread
constexpr double kMissesAll = 0.9;     // misfit of a model that is not followed at all
constexpr double kExplains = 0.35;     // of that misfit is left by the right reading
constexpr double kAlike = 1.2;         // misfits of two readings, neither of which is the better one,
constexpr double kSmallMisfit = 0.03;  // or both are as small as this
constexpr double kClearly = 0.5;       // of what a clock leaves is left by a filter, where it is one
constexpr double kLongest = 20.0;      // s of a run that are looked at
constexpr std::size_t kFewestRows = 200;
constexpr double kBallistic = 0.5;         // s, windows of a mechanism without a spring
constexpr double kLongestShift = 2.0;      // s
constexpr double kLate = 0.2;              // s; less is a lag of the sensor
constexpr double kEarly = 0.005;           // s, and two rows: no effect comes before its cause
constexpr double kGramForce = 9.80665e-3;  // N
constexpr double kVisible = 20.0;          // noises that a motion must have

// One way in which the file may have been meant.
struct Reading {
  std::string cause, channel;
  std::string meaning;  // "is in metres and not in millimetres"
  std::string remedy;   // of dataset.toml
  std::function<void(RecordedRun&)> apply;
  std::string otherwise = {};  // what else moves a force-driven mechanism in that way; empty: nothing
  double misses = kMisses;     // misfit from which it is possible
};

// RMS difference, as a share of the larger one's RMS.
double misfit(const std::vector<double>& a, const std::vector<double>& b) {
  double apart = 0.0, aa = 0.0, bb = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    apart += (a[i] - b[i]) * (a[i] - b[i]), aa += a[i] * a[i], bb += b[i] * b[i];
  const double largest = std::max(aa, bb);
  return largest > 0.0 && std::isfinite(apart) ? std::sqrt(apart / largest) : 1.0;
}

void scale(std::vector<double>& values, double factor) {
  for (double& value : values) value *= factor;
}

std::string times_too_small(double factor) {
  const double times = std::max(factor, 1.0 / factor);
  return fmt::format("{} times too {}",
                     times < 99.5 ? fmt::format("{:.3g}", times) : fmt::format("{:.0f}", times),
                     factor > 1.0 ? "small" : "large");
}

Reading in_unit(const std::string& quantity, const std::string& channel, const std::string& unit,
                const std::string& expected, std::vector<double> RecordedRun::*values, double factor) {
  return {"unit",
          channel,
          fmt::format("{} is in {} and not in {}", channel, unit, expected),
          fmt::format("[columns] {} = {{ name = \"{}\", unit = \"{}\" }}", quantity, channel, unit),
          [=](RecordedRun& run) { scale(run.*values, factor); },
          "m, c_s and k of the model are " +
              times_too_small(values == &RecordedRun::displacement ? factor : 1.0 / factor)};
}

Reading slower(double factor) {
  return {"unit",
          "time_s",
          fmt::format("time runs {:g} times as fast as time_s says", 1.0 / factor),
          fmt::format("[columns] time = {{ factor = {:g} }}", factor),
          [factor](RecordedRun& run) {
            scale(run.time, factor);
            run.period *= factor;
          },
          "m of the model is " + times_too_small(1.0 / (factor * factor)) + " and c_s " +
              times_too_small(1.0 / factor)};
}

std::vector<Reading> readings(Drive drive) {
  const bool stack = drive == Drive::Stack;
  const std::string input = stack ? "voltage_V" : "force_N", key = stack ? "voltage" : "force";
  const auto displacement = &RecordedRun::displacement;
  std::vector<Reading> out{
      in_unit("displacement", "displacement_mm", "m", "mm", displacement, 1e3),
      in_unit("displacement", "displacement_mm", "um", "mm", displacement, 1e-3),
      in_unit("displacement", "displacement_mm", "cm", "mm", displacement, 10.0),
      in_unit("displacement", "displacement_mm", "nm", "mm", displacement, 1e-6),
      in_unit("displacement", "displacement_mm", "in", "mm", displacement, 25.4),
      in_unit(key, input, stack ? "kV" : "kN", stack ? "V" : "N", &RecordedRun::input, 1e3),
      in_unit(key, input, stack ? "mV" : "mN", stack ? "V" : "N", &RecordedRun::input, 1e-3)};
  if (!stack) {
    out.push_back(in_unit(key, input, "gf", "N", &RecordedRun::input, kGramForce));
    out.push_back(in_unit(key, input, "kgf", "N", &RecordedRun::input, 1e3 * kGramForce));
  }
  const std::string turned = stack ? "displacement_mm" : "displacement_mm (or force_N)";
  out.push_back({"sign", turned, "displacement_mm counts against the model's direction",
                 "[columns] displacement = { sign = -1 }",
                 [=](RecordedRun& run) { scale(run.displacement, -1.0); }});
  out.push_back(
      {"swapped", input, fmt::format("{} and displacement_mm are exchanged", input),
       fmt::format("[columns] {} = {{ name = \"displacement_mm\", unit = \"{}\" }} and displacement = "
                   "{{ name = \"{}\", unit = \"mm\" }}",
                   key, stack ? "V" : "N", input),
       [](RecordedRun& run) {
         std::swap(run.input, run.displacement);
         scale(run.input, 1e3);
         scale(run.displacement, 1e-3);
       }});
  for (const double factor : {10.0, 0.1, 1e3, 1e-3, 2.0, 0.5, 60.0}) out.push_back(slower(factor));
  if (!stack) return out;
  out.push_back({"unit", "weight_g", "weight_g is in kg and not in g", "weight_g in grams",
                 [](RecordedRun& run) { run.weight *= 1e3; }});
  // A weight a thousand times too large leaves nothing of the motion; one that only seems to be none has a
  // force that lifts plate A beside it.
  out.push_back({.cause = "unit",
                 .channel = "weight_g",
                 .meaning = "weight_g is in mg and not in g",
                 .remedy = "weight_g in grams",
                 .apply = [](RecordedRun& run) { run.weight *= 1e-3; },
                 .misses = kMissesAll});
  return out;
}

// Measured and predicted motion of one run. Without a spring a mechanism drifts: then each window's departure
// from uniform motion.
struct Motions {
  std::vector<double> time, measured, predicted;
  double size = 0.0, misfit = 0.0;  // m RMS of the larger one; of their difference, as a share of it
};

RecordedRun beginning(RecordedRun run) {
  const auto rows =
      std::min(run.time.size(), std::max(kFewestRows, static_cast<std::size_t>(kLongest / run.period) + 1));
  for (std::vector<double>* values : {&run.time, &run.input, &run.displacement, &run.external_force})
    values->resize(rows);
  return run;
}

Motions motions(RecordedRun run, const PlantModel& model, double noise) {
  const bool drifts = model.baseline.drive == Drive::Force && model.baseline.k <= 0.0;
  Dataset alone{.title = {}, .sensor_noise = noise, .runs = {std::move(run)}};
  const std::optional<double> window =
      drifts ? std::optional(std::max(kBallistic, 8.0 * alone.runs[0].period)) : std::nullopt;
  const Evidence evidence = prepare(alone, model, window, Sampling::Coarse);
  const EvidenceRun& rows = evidence.runs.front();
  Motions out;
  out.predicted = predict(model, evidence, rows, rows.rows.size());
  auto next = rows.windows.begin();
  WindowStart start;
  double begun = 0.0;
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    if (next != rows.windows.end() && next->row == i) start = *next++, begun = rows.rows[i].time;
    const double uniform = drifts ? start.x + start.v * (rows.rows[i].time - begun) : 0.0;
    out.time.push_back(rows.rows[i].time);
    out.measured.push_back(rows.rows[i].measured - uniform);
    out.predicted[i] -= uniform;
  }
  out.size = std::max(rms(out.measured), rms(out.predicted));
  out.misfit = misfit(out.measured, out.predicted);
  return out;
}

// `values` at `time` + shift, on straight lines; the ends held.
std::vector<double> shifted(const Motions& motion, double shift) {
  std::vector<double> out;
  std::size_t at = 0;
  const std::vector<double>&t = motion.time, &x = motion.measured;
  for (const double now : t) {
    const double wanted = now + shift;
    while (at > 0 && t[at] > wanted) --at;
    while (at + 2 < t.size() && t[at + 1] <= wanted) ++at;
    const double share = std::clamp((wanted - t[at]) / (t[at + 1] - t[at]), 0.0, 1.0);
    out.push_back(x[at] + share * (x[at + 1] - x[at]));
  }
  return out;
}

// What a filter of that time constant (s) reads of the predicted motion.
std::vector<double> filtered(const Motions& motion, double lag) {
  std::vector<double> out;
  double y = motion.predicted.front();
  for (std::size_t i = 0; i < motion.time.size(); ++i) {
    const double h = i > 0 ? motion.time[i] - motion.time[i - 1] : 0.0;
    out.push_back(y += (motion.predicted[i] - y) * -std::expm1(-h / lag));
  }
  return out;
}

double least_misfit_of_a_filter(const Motions& motion) {
  double least = motion.misfit;
  for (double lag = 0.1; lag < 2.0 * kLongestShift; lag *= 1.15)
    least = std::min(least, misfit(filtered(motion, lag), motion.measured));
  return least;
}

// Delay of the measured motion against the model's, s; 0 where none explains the misfit, or a filter of the
// reading, which leaves `by_filter`, explains a late one far better.
double time_offset(const Motions& motion, double by_filter) {
  const double fine = std::max(motion.time[1] - motion.time[0], 1e-3);
  double best = 0.0, least = motion.misfit;
  const auto look = [&](double from, double to, double step) {
    for (double shift = from; shift <= to; shift += step)
      if (const double m = misfit(shifted(motion, shift), motion.predicted); m < least)
        least = m, best = shift;
  };
  look(-kLongestShift, kLongestShift, 10.0 * fine);
  look(best - 10.0 * fine, best + 10.0 * fine, fine);
  const bool strange = best > kLate || best < -std::max(kEarly, 2.0 * fine);
  if (!strange || least >= kExplains * motion.misfit) return 0.0;
  return best > 0.0 && by_filter < kClearly * least ? 0.0 : best;
}

struct Looked {
  const Reading* reading = nullptr;
  double offset = 0.0;                       // s
  double before = 0.0, after = 0.0;          // misfits
  std::map<const Reading*, double> meant{};  // misfit of each reading that explains the run
};

Looked look_at(const RecordedRun& recorded, const PlantModel& model, double noise,
               const std::vector<Reading>& all) {
  const RecordedRun run = beginning(recorded);
  const Motions as_given = motions(run, model, noise);
  Looked out{.before = as_given.misfit, .after = as_given.misfit};
  if (as_given.misfit * as_given.size < kVisible * noise) return out;
  const double by_filter = least_misfit_of_a_filter(as_given);  // an effect of the sensor, not of the clock
  for (const Reading& reading : all) {
    if (as_given.misfit < reading.misses) continue;
    RecordedRun other = recorded;
    reading.apply(other);
    const double rate = 1.0 / other.period;
    if (rate < 1.0 || rate > 1e6) continue;
    const Motions meant = motions(beginning(std::move(other)), model, noise);
    if (!(meant.misfit < kExplains * as_given.misfit)) continue;
    if (reading.channel == "time_s" && by_filter < kClearly * meant.misfit) continue;
    out.meant[&reading] = meant.misfit;
    if (meant.misfit < out.after) out.after = meant.misfit, out.reading = &reading;
  }
  if (out.reading == nullptr && model.baseline.k > 0.0 && run.time.size() > 2)
    out.offset = time_offset(as_given, by_filter);
  return out;
}

// Millimetres for micrometres and kilonewtons for newtons are the same to a linear mechanism: a reading that
// explains all runs that any explains is taken for all of them, the best of several.
void agree_on_one_reading(std::vector<Looked>& looked) {
  std::map<const Reading*, std::pair<std::size_t, double>> together;  // runs, sum of misfits
  std::size_t misread = 0;
  for (const Looked& one : looked) {
    misread += one.reading != nullptr ? 1 : 0;
    for (const auto& [reading, misfit] : one.meant)
      ++together[reading].first, together[reading].second += misfit;
  }
  const Reading* best = nullptr;
  for (const auto& [reading, sum] : together)
    if (sum.first == misread && (best == nullptr || sum.second < together[best].second)) best = reading;
  if (best == nullptr) return;
  for (Looked& one : looked)
    if (one.reading != nullptr) one.reading = best, one.after = one.meant.at(best);
}

std::string share_text(double misfit) {
  return fmt::format("{:.0f} %", 100.0 * std::max(0.0, 1.0 - misfit * misfit));
}

// Other readings that explain each of these runs nearly as well; most that is wrong with a file is one of
// several things.
std::string alternatives(const Reading& reading, const std::vector<Looked>& looked,
                         const std::vector<std::size_t>& which) {
  std::vector<std::string> out;
  for (const auto& [other, first] : looked[which.front()].meant)
    if (other != &reading && std::ranges::all_of(which, [&](std::size_t i) {
          const auto there = looked[i].meant.find(other);
          return there != looked[i].meant.end() &&
                 there->second < std::max(kAlike * looked[i].after, kSmallMisfit);
        }))
      out.push_back(other->meaning);
  std::ranges::sort(out);
  return out.empty() ? "" : fmt::format(" As well explained if {}.", fmt::join(out, "; or if "));
}

DataRemark misread(const Reading& reading, const std::vector<std::string>& runs, std::size_t of,
                   const Looked& one, Drive drive) {
  std::string sentence = fmt::format(
      "It seems that {} in {}: so read, the model reproduces {} of the motion of run {}, as "
      "given {}. If it is so, write in dataset.toml: {}{}.",
      reading.meaning, run_list(runs, of), share_text(one.after), runs.front(), share_text(one.before),
      reading.remedy, runs.size() == of ? "" : " (as [run.columns] of the run)");
  if (drive == Drive::Force && runs.size() == of && !reading.otherwise.empty())
    sentence +=
        fmt::format(" If the file is right, {}: correct them there, or say that they are not known (--free).",
                    reading.otherwise);
  return {reading.cause, reading.channel, runs, true, std::move(sentence)};
}

// Two runs that the model misses, each of which fits the other's input.
std::optional<DataRemark> exchanged(const Dataset& dataset, const std::vector<std::size_t>& missed,
                                    const PlantModel& model, double noise,
                                    const std::vector<Looked>& looked) {
  for (const std::size_t i : missed)
    for (const std::size_t j : missed) {
      const RecordedRun &a = dataset.runs[i], &b = dataset.runs[j];
      if (j <= i || a.period != b.period) continue;
      const std::size_t rows = std::min(a.time.size(), b.time.size());
      RecordedRun mixed = a, other = b;
      for (std::vector<double>* values : {&mixed.time, &mixed.input, &mixed.external_force, &other.time,
                                          &other.input, &other.external_force})
        values->resize(rows);
      mixed.displacement.assign(b.displacement.begin(), b.displacement.begin() + static_cast<long>(rows));
      other.displacement.assign(a.displacement.begin(), a.displacement.begin() + static_cast<long>(rows));
      if (motions(beginning(mixed), model, noise).misfit < kExplains * looked[i].before &&
          motions(beginning(other), model, noise).misfit < kExplains * looked[j].before)
        return DataRemark{
            "swapped",
            "file",
            {a.name, b.name},
            true,
            fmt::format("The displacements of runs {} and {} fit each other's input: their files "
                        "or columns are exchanged. Correct `file` in dataset.toml.",
                        a.name, b.name)};
    }
  return {};
}

DataRemark shifted_time(const std::string& run, double offset) {
  return {
      "time_offset",
      "time_s",
      {run},
      true,
      fmt::format("The displacement of run {} comes {:.3g} s {} the input that causes it, as the model sees "
                  "it: the two columns were recorded with different clocks. Shift one of them.",
                  run, std::abs(offset), offset < 0.0 ? "before" : "after")};
}

}  // namespace

std::vector<DataRemark> examine_with_model(const Dataset& dataset, const PlantModel& model, double noise) {
  const std::vector<Reading> all = readings(model.baseline.drive);
  std::vector<Looked> looked(dataset.runs.size());
  in_parallel(looked.size(), [&](std::size_t i) { looked[i] = look_at(dataset.runs[i], model, noise, all); });
  agree_on_one_reading(looked);
  std::vector<DataRemark> out;
  std::map<const Reading*, std::vector<std::size_t>> by_reading;
  std::vector<std::size_t> missed;
  for (std::size_t i = 0; i < looked.size(); ++i) {
    if (looked[i].reading != nullptr)
      by_reading[looked[i].reading].push_back(i);
    else if (looked[i].offset == 0.0 && looked[i].before > kMisses)
      missed.push_back(i);
  }
  const auto late = static_cast<std::size_t>(std::ranges::count_if(
      looked, [](const Looked& one) { return one.reading == nullptr && one.offset > 0.0; }));
  for (std::size_t i = 0; i < looked.size(); ++i) {
    // Friction makes a slow triangle late; but it disturbs the other runs as well.
    const bool of_the_clock = looked[i].offset < 0.0 || late > missed.size();
    if (looked[i].reading == nullptr && looked[i].offset != 0.0 && of_the_clock)
      out.push_back(shifted_time(dataset.runs[i].name, looked[i].offset));
  }
  for (const auto& [reading, which] : by_reading) {
    // A clock's unit is that of all runs; one run alone resembles another rate by chance.
    if (reading->channel == "time_s" && which.size() < dataset.runs.size()) continue;
    std::vector<std::string> names;
    for (const std::size_t i : which) names.push_back(dataset.runs[i].name);
    out.push_back(misread(*reading, names, dataset.runs.size(), looked[which.front()], model.baseline.drive));
    out.back().sentence += alternatives(*reading, looked, which);
  }
  if (out.empty())
    if (auto found = exchanged(dataset, missed, model, noise, looked)) out.push_back(std::move(*found));
  return out;
}

}  // namespace biopsy::sim::gap
