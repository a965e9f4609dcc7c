// biopsy-stage RUN_FOLDER: owns sensors and amplifier, simulated or real, and holds the gate.
#include <cmath>

#include "robot/live/live_process.hpp"
#include "robot/live/processes/commissioned_stage.hpp"
#include "robot/live/processes/io_stages.hpp"
#include "robot/live/realtime/tick_clock.hpp"
#include "robot/live/stage_loop.hpp"
#include "robot/procedure/rehearsed_plant.hpp"
#include "sim/draw_back.hpp"
#include "sim/faults/fault_file.hpp"
#include "sim/faults/faulty_stage.hpp"

namespace {

using namespace biopsy;

constexpr logging::TickEvent kDeviceError{logging::Level::Warning,
                                          "the stage's driver reports error {0:.0f}; errors so far: {1:.0f}"};

// `after_tick` gets the time from before the tick: what the tick read is at least so new.
template <class AfterTick>
void run(live::LiveProcess& process, live::StageLoop& loop, const AfterTick& after_tick) {
  process.start_ticking();
  realtime::TickClock clock(kTick);
  while (!process.stop_asked()) {
    const realtime::Wake wake = clock.wait();
    const std::int64_t now_us = wake.woke_ns / 1000;
    loop.heartbeat().lateness().record(wake.late_ns());
    loop.heartbeat().health().overruns = static_cast<std::uint32_t>(clock.missed());
    loop.tick(now_us);
    after_tick(now_us);
    process.after_tick(now_us, loop.heartbeat().health());
  }
  loop.switch_off(realtime::monotonic_ns() / 1000);
}

std::int32_t nanometres(double metres) {
  return static_cast<std::int32_t>(std::lround(metres * 1e9));
}

void run_simulated(live::LiveProcess& process, digital_io::StageIo& io) {
  const live::LiveSettings& settings = process.settings();
  const digital_io::IoReader relay(settings.lines);
  sim::SimulatedStage simulated(
      robot::rehearsed_plant(settings.model, settings.tissues, settings.layers, settings.weight_g),
      settings.seed);
  const std::vector<sim::Fault> faults =
      settings.faults.empty() ? std::vector<sim::Fault>{} : sim::read_faults(settings.faults);
  sim::FaultyStage faulty(simulated, faults, settings.seed);
  robot::SimulatedNeedleStage stage(faulty, io, relay);
  live::StageLoop loop(process.bus(), stage, io, process.config_tag());
  transport::Writer<StageTruth> truths(process.bus());
  sim::DrawBack person;
  run(process, loop, [&](std::int64_t read_us) {
    io.mark_panel_read(read_us * 1000);
    person.tick(simulated, loop.measured().hv_enabled);
    const sim::PlantState& state = simulated.truth();
    truths.write({.seq = loop.measured().seq,
                  .tip_nm = nanometres(state.motion.x),
                  .plate_b_nm = nanometres(sim::plate_b(simulated.model(), state)),
                  .layers_entered = static_cast<std::uint8_t>(sim::layers_entered(simulated.model(), state)),
                  .active_faults = faulty.active_faults()});
  });
}

// Refuses to start without the commissioning record of this very stage.
void run_hardware(live::LiveProcess& process, digital_io::StageIo& io) {
  const live::LiveSettings& settings = process.settings();
  const auto hardware = robot::open_commissioned_stage(settings.device, settings.device_config,
                                                       settings.commissioning, settings.commissioning_key);
  digital_io::PanelIo panel(settings.lines);
  robot::MirroredNeedleStage stage(*hardware, io);
  live::StageLoop loop(process.bus(), stage, io, process.config_tag());
  std::uint32_t errors = 0;
  run(process, loop, [&](std::int64_t read_us) {
    const drivers::DeviceError& error = hardware->last_error();
    if (error.count > 0) loop.heartbeat().note(error.text.data());
    if (error.count != errors)
      process.tick_log().record(kDeviceError, loop.measured().time_us, error.status, error.count);
    errors = error.count;
    const drivers::Panel keys = hardware->panel();
    panel.set(robot::panel_levels(keys));
    if (keys.read) io.mark_panel_read(read_us * 1000);
  });
}

void drive_stage(const std::filesystem::path& run_folder) {
  live::LiveProcess process(run_folder, security::Role::Stage);
  digital_io::StageIo io(process.settings().lines);
  if (drivers::is_simulated(process.settings().device))
    run_simulated(process, io);
  else
    run_hardware(process, io);
}

}  // namespace

int main(int argc, char** argv) {
  return live::live_main(argc, argv, "stage", drive_stage);
}
