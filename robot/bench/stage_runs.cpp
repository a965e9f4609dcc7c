#include "robot/bench/stage_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robot/bench/hand_push.hpp"
#include "robot/live/processes/commissioned_stage.hpp"
#include "sim/simulated_stage.hpp"

namespace biopsy::robot {
namespace {

std::string instruction_before_key(const BenchRun& run) {
  std::string weights;
  if (!run.loads.empty()) {
    const auto [least, most] = std::ranges::minmax(run.loads, {}, &LoadStep::push_N);
    weights =
        fmt::format("{:.0f} x {:.0f} g ready on an insulating rod, to be laid on under voltage when asked; ",
                    most.push_N / least.push_N, grams_of(least.push_N));
  }
  return fmt::format(
      "{}: {:.0f} g and nothing else on the fixture; {}hands off, then turn the arm key (off first, if it is "
      "on)",
      run.name, run.setup.weight.value, weights);
}

std::vector<std::string> remarks_on(const std::vector<HandPush>& pushes, const BenchResult& result) {
  std::vector<std::string> remarks{
      "weights were laid on by hand; each pushes from where the depth first follows, to some 50 ms, and the "
      "mass that came with it is not in the data"};
  for (const HandPush& push : pushes)
    if (!push.seen)
      remarks.push_back(
          fmt::format("the depth does not show the change to {:.0f} g that was asked for at {:.2f} s: it was "
                      "not made, or friction held the plate",
                      grams_of(push.force_N), push.requested_s));
  if (const double left_N = result.recorded.external_force.back(); left_N > 0.0)
    remarks.push_back(fmt::format("{:.0f} g still lay on the plate when it was stopped", grams_of(left_N)));
  return remarks;
}

void date_pushes(const BenchRun& run, BenchResult& result) {
  if (run.loads.empty() || result.recorded.time.empty()) return;
  const std::size_t under_program =
      result.stopped_because.empty()
          ? result.recorded.time.size()
          : static_cast<std::size_t>(std::llround(result.stopped_s / result.recorded.period));
  const std::size_t period_rows = 2 * static_cast<std::size_t>(run.program.half_period_ticks);
  result.remarks = remarks_on(date_by_depth(result.recorded, period_rows, under_program), result);
}

}  // namespace

BenchResult run_simulated(const BenchSession& session, std::size_t i, std::uint64_t seed,
                          const RunHooks& hooks) {
  const BenchRun& run = session.runs[i];
  sim::PlantModel model = session.model;
  model.weight = run.setup.weight.value * 1e-3;
  sim::SimulatedStage stage(model, seed + i);
  return run_on_bench(run, session.plans[i], 1 + seed,
                      {.stage = stage,
                       .push = [&](double force_N) { stage.push(force_N); },
                       .show_progress = hooks.show_progress,
                       .stop = hooks.stop});
}

BenchResult run_on_hardware(const BenchSession& session, std::size_t i, std::uint64_t config_tag,
                            drivers::HardwareNeedleStage& hardware, drivers::PulseOutput& supervisor_pulse,
                            const RunHooks& hooks) {
  const BenchRun& run = session.runs[i];
  hooks.notify(fmt::format(
      "{}: at 0 V for {:.0f} s, in which the model's films lose their charge; measure before you touch",
      run.name, session.rest().count()));
  const auto request_weight = [&run, &hooks, on_plate_N = 0.0](double push_N) mutable {
    if (push_N == on_plate_N) return;
    hooks.notify(fmt::format("\n{}: NOW {} {:.0f} g, within 3 s", run.name,
                             push_N > on_plate_N ? "lay on" : "lift off",
                             grams_of(std::abs(push_N - on_plate_N))));
    on_plate_N = push_N;
  };
  const auto keys = [&hardware] {
    const drivers::Panel panel = hardware.panel();
    return BenchKeys{panel.arm, panel.estop_a_closed && panel.estop_b_closed};
  };
  RealtimeNeedleStage stage(hardware);
  BenchResult result = run_on_bench(run, session.plans[i], config_tag,
                                    {.stage = stage,
                                     .push = request_weight,
                                     .show_progress = hooks.show_progress,
                                     .keys = keys,
                                     .supervisor_pulse = &supervisor_pulse,
                                     .rest = session.rest(),
                                     .request_key = [&] { hooks.notify(instruction_before_key(run)); },
                                     .stop = hooks.stop});
  date_pushes(run, result);
  return result;
}

}  // namespace biopsy::robot
