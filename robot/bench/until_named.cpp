#include "robot/bench/until_named.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "robot/common/config_error.hpp"
#include "robot/common/progress.hpp"
#include "robot/report/gap/gap_labels.hpp"
#include "sim/plant/model_file.hpp"
#include "sim/plant/simulate.hpp"

namespace biopsy::robot {
namespace {

constexpr double kPossible = 0.05;  // a rival more probable than that is not excluded

bool stands_alone(const GapFinding& finding) {
  if (finding.verdict != GapVerdict::Effect || finding.partial) return false;
  return std::ranges::none_of(finding.effects, [](const FoundEffect& effect) {
    return std::ranges::any_of(effect.confused_with,
                               [](const GapProbability& rival) { return rival.probability > kPossible; });
  });
}

std::string experiment_of(const BenchRun& run) {
  return run.name.substr(0, run.name.find('-'));
}

// What the run would be as a recording, without readings.
sim::RecordedRun programmed(const BenchRun& run) {
  sim::RecordedRun out;
  out.name = run.name;
  out.weight = 1e-3 * run.setup.weight.value;
  out.period = Seconds(kTick).count();
  const control::VoltageProgram& program = run.program;
  for (std::uint32_t tick = 0; tick < control::length_ticks(program); ++tick) {
    const bool turned = program.half_period_ticks > 0 && tick / program.half_period_ticks % 2 == 1;
    out.time.push_back(tick * out.period);
    out.input.push_back((turned ? -1.0 : 1.0) * program.sign * control::amplitude_at(program, tick).value);
    out.external_force.push_back(push_at(run, tick));
    out.displacement.push_back(0.0);
  }
  return out;
}

}  // namespace

double predicted_difference(const BenchRun& run, const sim::PlantModel& a, const sim::PlantModel& b) {
  const auto readings = [recorded = programmed(run)](sim::PlantModel model) {
    model.effects.sensor_noise.reset();
    return sim::simulate(std::move(model), recorded).displacement;
  };
  const std::vector<double> first = readings(a), second = readings(b);
  double sum = 0.0;
  for (std::size_t i = 0; i < first.size(); ++i) sum += std::pow(first[i] - second[i], 2);
  return std::sqrt(sum / static_cast<double>(first.size()));
}

UntilNamed::UntilNamed(const BenchSession& session, const std::filesystem::path& model, std::stop_token stop)
    : session_(session), model_(sim::read_model(model)), stop_(std::move(stop)) {
  if (model_.baseline.drive != sim::Drive::Stack)
    throw ConfigError("the model is driven by a force and has no voltage", model.string(),
                      "give --until-named a model of the stage with its stack");
  for (const BenchRun& run : session.runs)
    if (const std::string name = experiment_of(run); left_.empty() || left_.back() != name)
      left_.push_back(name);
}

std::vector<std::size_t> UntilNamed::next(const sim::Dataset& recorded) {
  if (recorded.runs.empty()) return runs_of(left_.front());
  ProgressLine line;
  sim::gap::SearchOptions options;
  options.stop = stop_;
  const sim::gap::FoundGap found =
      sim::gap::find_gap(recorded, model_, options, [&](double share, const std::string&) {
        line.show(share, fmt::format("comparing {} runs with the model", recorded.runs.size()));
      });
  const GapFinding& finding = found.finding;
  NamingRound round{.experiment = last_,
                    .verdict = std::string(report::label(finding.verdict)),
                    .effect = {},
                    .gap_closed = finding.gap_closed,
                    .decision = {}};
  if (!finding.effects.empty())
    round.effect = finding.effects.front().name, round.probability = finding.effects.front().probability;
  const Choice choice = finding.interrupted ? Choice{{}, "Interrupted."} : choose(found);
  round.decision = choice.why;
  rounds_.push_back(std::move(round));
  return choice.experiment.empty() ? std::vector<std::size_t>{} : runs_of(choice.experiment);
}

UntilNamed::Choice UntilNamed::choose(const sim::gap::FoundGap& found) const {
  const GapFinding& finding = found.finding;
  if (!finding.data.empty() && finding.data.front().blocks) return {{}, finding.data.front().sentence};
  if (stands_alone(finding)) return confirming(found);
  if (left_.empty()) return {{}, "No experiment is left."};
  if (!found.rivals.empty()) return separating(found.rivals, finding.noise_floor);
  return in_order(finding.verdict == GapVerdict::Unexplained ? "Nothing explains what is recorded"
                                                             : "No effect is missing so far");
}

UntilNamed::Choice UntilNamed::confirming(const sim::gap::FoundGap& found) const {
  const std::string& name = found.finding.effects.front().name;
  if (!rounds_.empty() && rounds_.back().effect == name)
    return {{}, fmt::format("Named: {}, confirmed by a further experiment.", name)};
  if (left_.empty()) return {{}, fmt::format("Named: {}; no experiment is left to confirm it.", name)};
  if (!found.rivals.empty())
    if (Choice choice = separating(found.rivals, found.finding.noise_floor); !choice.experiment.empty())
      return choice;
  return in_order(fmt::format("{} is to be confirmed", name));
}

UntilNamed::Choice UntilNamed::separating(const std::vector<sim::gap::FoundGap::Rival>& rivals,
                                          double noise_mm) const {
  const auto &first = rivals[0], &second = rivals[1];
  double most_mm = 0.0;
  std::string best;
  for (const BenchRun& run : session_.runs) {
    const std::string name = experiment_of(run);
    if (std::ranges::find(left_, name) == left_.end()) continue;
    const double apart_mm = 1e3 * predicted_difference(run, first.model, second.model);
    if (std::isfinite(apart_mm) && apart_mm > most_mm) most_mm = apart_mm, best = name;
  }
  if (most_mm <= noise_mm)
    return {
        {},
        fmt::format("{} and {} cannot be told apart: in no experiment that is left do they differ by more "
                    "than a reading scatters ({:.3g} mm).",
                    first.name, second.name, noise_mm)};
  return {best, fmt::format("Next {}: there {} and {} differ by {:.3g} mm.", best, first.name, second.name,
                            most_mm)};
}

UntilNamed::Choice UntilNamed::in_order(const std::string& why) const {
  return {left_.front(), fmt::format("{}; next {}.", why, left_.front())};
}

std::vector<std::size_t> UntilNamed::runs_of(const std::string& experiment) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < session_.runs.size(); ++i)
    if (experiment_of(session_.runs[i]) == experiment) out.push_back(i);
  last_ = experiment;
  std::erase(left_, experiment);
  return out;
}

std::string to_text(const std::vector<NamingRound>& rounds) {
  std::string out;
  for (const NamingRound& round : rounds) {
    const std::string found = round.effect.empty() ? round.verdict
                                                   : fmt::format("{} ({:.2f}), closes {:.0f} %", round.effect,
                                                                 round.probability, 100.0 * round.gap_closed);
    out += fmt::format("after {}: {}. {}\n", round.experiment, found, round.decision);
  }
  return out;
}

}  // namespace biopsy::robot
