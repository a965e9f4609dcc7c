#include "tests/sim/gap/generator/hidden_data.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "tests/sim/gap/generator/hidden_programs.hpp"

namespace biopsy::hidden {
namespace {

constexpr double kMm = 1e3;

struct Truth {
  StageNumbers stage;
  MechanismNumbers mechanism;
};

using StageNumber = std::pair<const char*, double StageNumbers::*>;
using MechanismNumber = std::pair<const char*, double MechanismNumbers::*>;
constexpr StageNumber kStage[] = {{"K", &StageNumbers::K},    {"tau", &StageNumbers::tau},
                                  {"V0", &StageNumbers::V0},  {"tau_h", &StageNumbers::tau_h},
                                  {"k", &StageNumbers::k},    {"c_s", &StageNumbers::c_s},
                                  {"c_k", &StageNumbers::c_k}};
constexpr MechanismNumber kMechanism[] = {
    {"m", &MechanismNumbers::m}, {"c_s", &MechanismNumbers::c_s}, {"k", &MechanismNumbers::k}};

void scale(Truth& truth, bool force_drive, const std::string& name, double factor) {
  bool found = false;
  if (force_drive)
    for (const auto& [key, number] : kMechanism)
      if (name == key) truth.mechanism.*number *= factor, found = true;
  if (!force_drive)
    for (const auto& [key, number] : kStage)
      if (name == key) truth.stage.*number *= factor, found = true;
  if (!found) throw std::invalid_argument("no erring parameter named " + name);
}

std::vector<std::string> erring(bool force_drive) {
  std::vector<std::string> out;
  if (force_drive)
    for (const auto& one : kMechanism) out.emplace_back(one.first);
  else
    for (const auto& one : kStage) out.emplace_back(one.first);
  return out;
}

Truth true_numbers(const HiddenCase& hidden) {
  Truth truth;
  Dice dice(hidden.seed * 11 + 1);
  for (const std::string& name : erring(hidden.force_drive))
    scale(truth, hidden.force_drive, name,
          1.0 + dice.between(-hidden.parameter_error, hidden.parameter_error));
  for (const WrongParameter& wrong : hidden.wrong) scale(truth, hidden.force_drive, wrong.name, wrong.factor);
  return truth;
}

std::vector<NamedProgram> programs(const HiddenCase& hidden) {
  Dice dice(hidden.seed * 13 + 2);
  return hidden.force_drive ? mechanism_programs(hidden.runs, hidden.period, hidden.length, dice)
                            : stage_programs(hidden.runs, hidden.period, hidden.length, dice);
}

std::vector<Trace> simulate(const HiddenCase& hidden, const std::vector<NamedProgram>& all,
                            const Truth& truth, const HiddenPhysics& physics) {
  std::vector<Trace> out;
  for (std::size_t run = 0; run < all.size(); ++run) {
    const std::uint64_t seed = hidden.seed * 17 + run * 7919;
    out.push_back(hidden.force_drive ? run_mechanism(truth.mechanism, physics, all[run].program, seed)
                                     : run_stage(truth.stage, physics, all[run].program, seed));
  }
  return out;
}

Eigen::VectorXd stacked(const std::vector<Trace>& traces) {
  std::vector<double> rows;
  for (const Trace& trace : traces)
    rows.insert(rows.end(), trace.displacement.begin(), trace.displacement.end());
  return kMm * Eigen::Map<Eigen::VectorXd>(rows.data(), static_cast<Eigen::Index>(rows.size()));
}

double rms(const Eigen::VectorXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

// With the terms (or one of them) minus without.
Eigen::VectorXd difference(const HiddenCase& hidden, const std::string& only) {
  const auto all = programs(hidden);
  if (hidden.terms.empty())
    return stacked(simulate(hidden, all, true_numbers(hidden), {})) - stacked(simulate(hidden, all, {}, {}));
  HiddenCase without = hidden;
  std::erase_if(without.terms, [&](const HiddenTerm& term) { return only.empty() || term.name == only; });
  const Truth truth = true_numbers(hidden);
  return stacked(simulate(hidden, all, truth, hidden.physics())) -
         stacked(simulate(hidden, all, truth, without.physics()));
}

sim::RecordedRun recorded(const HiddenCase& hidden, const NamedProgram& named, const Trace& trace,
                          Dice& dice) {
  sim::RecordedRun run;
  run.name = named.name;
  run.file = named.name + ".csv";
  run.weight = named.program.weight;
  run.period = hidden.period;
  run.input = named.program.input;
  run.external_force = named.program.push;
  for (std::size_t row = 0; row < run.input.size(); ++row) {
    run.time.push_back(static_cast<double>(row) * hidden.period);
    run.displacement.push_back(trace.displacement[row] + 1e-6 * hidden.noise_um * dice.normal());
    if (hidden.plate_b && !hidden.force_drive)
      run.plate_b.push_back(trace.plate_b[row] + 1e-6 * hidden.noise_um * dice.normal());
    if (hidden.current && !hidden.force_drive)
      run.current.push_back(trace.current[row] + 50e-9 * dice.normal());
  }
  return run;
}

void write(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file);
  out << text;
  if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
}

}  // namespace

sim::Dataset make_hidden(const HiddenCase& hidden) {
  return make_hidden(hidden, hidden.physics());
}

sim::Dataset make_hidden(const HiddenCase& hidden, const HiddenPhysics& physics) {
  const auto all = programs(hidden);
  const auto traces = simulate(hidden, all, true_numbers(hidden), physics);
  sim::Dataset out;
  out.title = "recording " + std::to_string(hidden.seed);  // the name would give the answer away
  if (hidden.noise_given) out.sensor_noise = 1e-6 * hidden.noise_um;
  Dice dice(hidden.seed * 19 + 3);
  for (std::size_t run = 0; run < all.size(); ++run)
    out.runs.push_back(recorded(hidden, all[run], traces[run], dice));
  return out;
}

double effect_rms(const HiddenCase& hidden, const std::string& only) {
  return rms(difference(hidden, only));
}

double identifiable_rms(const HiddenCase& hidden, const std::string& only) {
  const Eigen::VectorXd gap = difference(hidden, only);
  const auto all = programs(hidden);
  const auto names = erring(hidden.force_drive);
  Eigen::MatrixXd slopes(gap.size(), static_cast<Eigen::Index>(names.size()));
  const Truth truth = true_numbers(hidden);
  const Eigen::VectorXd base = stacked(simulate(hidden, all, truth, {}));
  for (std::size_t i = 0; i < names.size(); ++i) {
    Truth up = truth;
    scale(up, hidden.force_drive, names[i], 1.01);
    slopes.col(static_cast<Eigen::Index>(i)) = stacked(simulate(hidden, all, up, {})) - base;
  }
  const Eigen::MatrixXd normal = slopes.transpose() * slopes;
  return rms(gap - slopes * normal.ldlt().solve(slopes.transpose() * gap));
}

double parameter_rms(const HiddenCase& hidden) {
  HiddenCase bare = hidden;
  bare.terms.clear();
  return rms(difference(bare, ""));
}

std::string baseline_model(const HiddenCase& hidden) {
  if (hidden.force_drive) {
    const MechanismNumbers b;
    return "[baseline]\ndrive = \"force\"\nm = " + std::to_string(b.m) + "\nc_s = " + std::to_string(b.c_s) +
           "\nk = " + std::to_string(b.k) + "\n";
  }
  return "[baseline]  # what is left out keeps the reference value\nK = 0.80\ntau = 6.9\nV0 = 1.9e-7\ntau_h "
         "= 0.030\n"
         "k = 140.0\nc_s = 0.60\nc_k = 0.05\n";
}

void write_hidden(const HiddenCase& hidden, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const sim::Dataset data = make_hidden(hidden);
  const sim::Drive drive = hidden.force_drive ? sim::Drive::Force : sim::Drive::Stack;
  for (const sim::RecordedRun& run : data.runs) write(folder / run.file, sim::run_csv(run, drive));
  write(folder / "dataset.toml", sim::dataset_toml(data));
  write(folder / "model.toml", baseline_model(hidden));
}

}  // namespace biopsy::hidden
