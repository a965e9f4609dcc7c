// How fast the rehearsal is: the whole lockstep, its parts, many stages at once, and the same baseline
// integrated by SUNDIALS CVODE. CPU time, best of several repetitions on one core.
//   bench_lockstep [--out FILE] [--held-against FILE]
// Exit code 3 where a figure lost more than a fifth of its speed against the peer, 2 for unusable input.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "planner/plan/plan_insertion.hpp"
#include "planner/plan/registration.hpp"
#include "planner/plan/seal.hpp"
#include "robot/common/config_error.hpp"
#include "robot/cycle/plan_facts.hpp"
#include "robot/cycle/simulated_robot.hpp"
#include "robot/procedure/operator.hpp"
#include "sim/plant/batch/batch.hpp"
#include "sim/plant/model_file.hpp"
#include "sim/plant/seeded_noise.hpp"
#include "sim/plant/stepper.hpp"
#include "sim/simulated_stage.hpp"
#include "sim/tissue/tissue.hpp"
#include "tests/bench/bench_result.hpp"
#include "tests/bench/cvode_peer.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::bench {
namespace {

constexpr int kRepetitions = 7;
constexpr int kTicks = 30'000;  // of the plant alone
constexpr double kTick_s = 1e-3;
constexpr std::size_t kBatch = 64;  // stages
double keep = 0.0;                  // read at the end, so that nothing is optimised away

// Seconds for one call, the fastest of several.
double best_of(const std::function<void()>& work) {
  double best = 1e9;
  for (int i = 0; i < kRepetitions; ++i) {
    const double begin = cpu_s();
    work();
    best = std::min(best, cpu_s() - begin);
  }
  return best;
}

// The paper's liver biopsy: 2.0 then 3.5 mm.
struct Biopsy {
  Plan plan;
  safety::PlanFacts facts;
  sim::PlantModel model;
};

Biopsy liver_biopsy() {
  const auto models = source_dir() / "sim" / "models";
  planner::InsertionRequest request;
  request.target.p_ST = Point(0, 0, 3.5);
  request.X_SR = planner::needle_pose(request.target.p_SE, request.target.p_ST);
  request.layers = {{"muscle", Millimetres(0), Millimetres(2)},
                    {"gap", Millimetres(2), Millimetres(2.9)},
                    {"liver", Millimetres(2.9), Millimetres(20)}};
  request.staging = planner::Staging::AsGiven;
  request.waypoints = {Millimetres(2)};
  Biopsy biopsy;
  biopsy.plan = std::get<Plan>(planner::plan_insertion(request));
  biopsy.facts = robot::plan_facts(biopsy.plan, 7);
  biopsy.model = sim::read_model(models / "rehearsal.toml");
  biopsy.model.tissue = sim::tissue_along(biopsy.plan.layers, sim::read_tissues(models / "tissues.toml"));
  return biopsy;
}

// What the parts of one tick were given, to run them again one by one.
struct Record {
  std::vector<robot::OperatorInputs> inputs;
  std::vector<robot::CycleRecord> ticks;
};

// The whole procedure; returns its ticks.
std::size_t lockstep_run(const Biopsy& biopsy, std::uint64_t seed, Record* record = nullptr) {
  sim::SimulatedStage stage(biopsy.model, seed);
  const std::uint64_t tag = planner::plan_tag(biopsy.plan);
  robot::SimulatedRobot lockstep(biopsy.plan, biopsy.facts, stage, {tag, tag});
  robot::Operator person(biopsy.plan, robot::kFastScan);
  robot::CycleRecord tick;
  std::int64_t k = 0;
  for (; k < 120'000 && !person.done(); ++k) {
    const robot::OperatorInputs inputs = person.act(tick, k);
    if (person.wants_verdict()) person.judge(DepthVerdict::Accept, "");
    tick = lockstep.run_cycle(inputs);
    person.observe(tick);
    if (record != nullptr) {
      record->inputs.push_back(inputs);
      record->ticks.push_back(tick);
    }
  }
  keep += stage.truth().motion.x + (person.completed() ? 1.0 : 0.0);
  return static_cast<std::size_t>(k);
}

// Supervisor and gate alone, over what a run recorded.
void safety_run(const Biopsy& biopsy, const Record& record) {
  const std::uint64_t tag = planner::plan_tag(biopsy.plan);
  robot::SupervisorMemory supervisor{.config_tag = biopsy.facts.config_tag,
                                     .self_test = safety::SelfTest::Passed,
                                     .plan = biopsy.facts,
                                     .sealed_tag = tag,
                                     .confirmed_tag = {tag, tag},
                                     .seal = biopsy.plan.seal,
                                     .state = safety::started(1)};
  robot::assume_tested_panel(supervisor);
  robot::SupervisorSources in;
  safety::GateState gate;
  for (std::size_t k = 0; k < record.ticks.size(); ++k) {
    in.now_us = static_cast<std::int64_t>(k + 1) * 1000;
    in.measurement = record.ticks[k].measurement;
    in.writers = 1;
    in.files_tag = biopsy.facts.config_tag, in.files_read_us = in.now_us;
    in.panel = {robot::panel_levels(record.inputs[k]), true};
    in.panel.levels.relay_closed =
        supervisor.permit.mode == Mode::Ready || safety::hv_permitted(supervisor.permit.mode);
    in.act = {robot::operator_act(record.inputs[k]), in.now_us};
    in.log.at_us = in.now_us;
    in.verdict = robot::depth_verdict(record.inputs[k], tag);
    const Permit permit = robot::supervise(in, supervisor).output.permit;
    in.request = record.ticks[k].request;
    const safety::GateResult result = safety::gate(gate, &in.request, &permit, in.now_us, in.writers);
    gate = result.state;
    keep += result.voltage.mV() * 1e-12;
  }
}

// Up, hold and down again at 2 Hz; V
std::vector<double> drive() {
  std::vector<double> voltage;
  for (int k = 0; k < kTicks; ++k) {
    const double t = k * kTick_s;
    const double steps = t < 10 ? 500.0 * std::floor(t) : t < 20 ? 4000.0 : 500.0 * std::floor(30.0 - t);
    voltage.push_back((k / 250) % 2 == 0 ? steps : -steps);
  }
  return voltage;
}

std::vector<double> plant_run(const sim::PlantModel& model, const std::vector<double>& voltage) {
  std::vector<double> x;
  sim::PlantState state = sim::at_rest(model);
  sim::Stepper stepper(model);
  for (const double volts : voltage) {
    stepper.advance(model, state, {.voltage = volts}, Seconds(kTick_s));
    x.push_back(state.motion.x);
  }
  return x;
}

std::string accuracy(const std::vector<double>& x, const std::vector<double>& exact) {
  if (exact.empty() || x.size() != exact.size()) return "";
  double worst = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) worst = std::max(worst, std::abs(x[k] - exact[k]));
  return fmt::format("worst error {:.3f} um", worst * 1e6);
}

// Stages like the reference, in lanes; the first is the reference.
std::vector<sim::PlantModel> stages_around(const sim::PlantModel& reference) {
  std::vector<sim::PlantModel> models(kBatch, reference);
  for (std::size_t i = 1; i < kBatch; ++i) {
    const double off = 0.2 * (sim::uniform(1, i) - 0.5);
    models[i].baseline.k *= 1.0 + off, models[i].baseline.c_s *= 1.0 - off;
  }
  return models;
}

// Deflection of the first stage.
std::vector<double> batch_run(const std::vector<sim::PlantModel>& models,
                              const std::vector<double>& voltage) {
  std::vector<double> x, volts(models.size());
  sim::PlantBatch batch(models, Seconds(kTick_s));
  for (const double now : voltage) {
    std::fill(volts.begin(), volts.end(), now);
    batch.step(volts);
    x.push_back(batch.x(0));
  }
  return x;
}

void measure_plants(BenchResult& result) {
  sim::PlantModel model;
  const std::vector<double> voltage = drive();
  const auto ticks = static_cast<double>(voltage.size());
  const std::vector<double> exact = cvode_run(model.baseline, model.weight, voltage, {1e-12, 1e-15, true});
  std::vector<double> x;
  const double own = best_of([&] { x = plant_run(model, voltage); }) / ticks;
  result.add({"plant", "baseline alone, sim/plant", own * 1e9, accuracy(x, exact)});
  const auto batch = [&](const std::string& name, const std::string& what) {
    const auto models = stages_around(model);
    const double seconds = best_of([&] { x = batch_run(models, voltage); }) / (ticks * kBatch);
    result.add({name, what, seconds * 1e9, accuracy(x, exact)});
  };
  batch("batch", fmt::format("  {} stages at once, each", kBatch));
  if (!cvode_is_there())
    return static_cast<void>(fmt::print("{:<52}{:>10}\n", "baseline by SUNDIALS CVODE", "not installed"));
  for (const bool every_tick : {true, false})
    for (const double relative : {1e-4, 1e-5, 1e-6}) {
      const PeerSettings settings{relative, relative * 1e-3, every_tick};
      const double peer =
          best_of([&] { x = cvode_run(model.baseline, model.weight, voltage, settings); }) / ticks;
      if (x.size() != voltage.size()) throw std::runtime_error("CVODE failed: no figure");
      result.add({fmt::format("cvode {:.0e}{}", relative, every_tick ? " each tick" : ""),
                  fmt::format("  CVODE Adams, rtol {:.0e}, restart {}", relative,
                              every_tick ? "each tick" : "at jumps only"),
                  peer * 1e9, fmt::format("{}, {:.1f} x the plant's time", accuracy(x, exact), peer / own)});
    }
  model.effects.coulomb_friction = sim::CoulombFriction{0.05};
  const double rubbing = best_of([&] { keep += plant_run(model, voltage).back(); }) / ticks;
  result.add({"plant with friction", "baseline with dry friction, sim/plant", rubbing * 1e9, ""});
  const auto models = stages_around(model);
  const double lanes = best_of([&] { keep += batch_run(models, voltage).back(); }) / (ticks * kBatch);
  result.add({"batch with friction", fmt::format("  {} stages at once, each", kBatch), lanes * 1e9, ""});
}

void measure_lockstep(BenchResult& result) {
  const Biopsy biopsy = liver_biopsy();
  std::size_t ticks = 0;
  const double whole = best_of([&] {
    ticks = 0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) ticks += lockstep_run(biopsy, seed);
  });
  result.add({"lockstep", "lockstep: stage, evidence, supervisor, loop, gate",
              whole / static_cast<double>(ticks) * 1e9, "liver biopsy, rehearsal model, tissue, noise"});
  Record record;
  lockstep_run(biopsy, 1, &record);
  const auto recorded = static_cast<double>(record.ticks.size());
  const double safety = best_of([&] { safety_run(biopsy, record); });
  result.add({"safety", "  evidence, supervisor and gate alone", safety / recorded * 1e9, ""});
  std::vector<double> volts;
  for (const robot::CycleRecord& tick : record.ticks) volts.push_back(tick.drive_mV * 1e-3);
  const double plant = best_of([&] { keep += plant_run(biopsy.model, volts).back(); });
  result.add({"plant in tissue", "  plant alone, same voltages, in tissue", plant / recorded * 1e9, ""});
}

int run(const std::string& out, const std::string& earlier) {
  BenchResult result;
  result.set_peer("cvode 1e-05");  // the nearest that is not more exact
  fmt::print("CPU time, best of {} on one core{:<21}{:>10}{:>12}\n", kRepetitions, "", "ns/tick",
             "x real time");
  measure_lockstep(result);
  measure_plants(result);
  if (!std::isfinite(keep)) return 1;
  if (!out.empty()) result.write(out);
  if (earlier.empty()) return 0;
  const std::string losses = result.losses(earlier);
  fmt::print("{}", losses.empty() ? "no figure lost a fifth of its speed\n" : "lost speed:\n" + losses);
  return losses.empty() ? 0 : 3;
}

}  // namespace
}  // namespace biopsy::bench

int main(int argc, char** argv) {
  std::string out, earlier;
  for (int i = 1; i < argc; i += 2) {
    const std::string option = argv[i];
    if (i + 1 < argc && option == "--out") {
      out = argv[i + 1];
    } else if (i + 1 < argc && option == "--held-against") {
      earlier = argv[i + 1];
    } else {
      fmt::print(stderr, "error: \"{}\"; bench_lockstep takes --out FILE and --held-against FILE\n", option);
      return 2;
    }
  }
  try {
    return biopsy::bench::run(out, earlier);
  } catch (const biopsy::ConfigError& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 2;
  }
}
