#include "sim/faults/faulty_stage.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sim/plant/seeded_noise.hpp"

namespace biopsy::sim {
namespace {

constexpr std::size_t kPast_ticks = 1000;
constexpr double kOscillation_Hz = 50.0;  // of the mains
constexpr double kTick_s = 1e-3;

std::int32_t to_count(double value) {
  return static_cast<std::int32_t>(std::lround(std::clamp(value, -2e9, 2e9)));
}

}  // namespace

FaultyStage::FaultyStage(SimulatedStage& sound, std::vector<Fault> faults, std::uint64_t seed)
    : sound_(sound), faults_(std::move(faults)), states_(faults_.size()), seed_(hashed(seed, 0x6661756c74)) {}

void FaultyStage::update_activity() {
  const double depth_mm = sound_.truth().motion.x * 1e3;
  const double armed_s = static_cast<double>(armed_ticks_) * kTick_s;
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    const Fault& fault = faults_[i];
    State& state = states_[i];
    const bool armed = armed_ticks_ >= 0;
    if (fault.until_s && armed && armed_s >= *fault.until_s) state.ended = true;
    if (state.active) ++state.ticks;
    if (!state.active && !state.ended && (!fault.from_s || (armed && armed_s >= *fault.from_s)) &&
        (!fault.from_depth_mm || depth_mm >= *fault.from_depth_mm))
      state.active = true;
    if (state.ended) state.active = false;
    const bool pauses = fault.on_ms > 0 && state.ticks % (fault.on_ms + fault.off_ms) >= fault.on_ms;
    state.shown_ticks = state.shows ? state.shown_ticks + 1 : 0;
    state.shows = state.active && !pauses;
  }
}

std::uint32_t FaultyStage::active_faults() const {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < states_.size(); ++i) bits |= std::uint32_t{states_[i].active} << i;
  return bits;
}

double FaultyStage::drawn(std::size_t i) {
  return uniform(seed_, (draws_++ << 5U) + i);
}

bool FaultyStage::is_lost(std::size_t i) {
  return states_[i].shows && faults_[i].kind == FaultKind::Dropout && drawn(i) < faults_[i].value;
}

// What the signal shows instead of its sound value.
double FaultyStage::shown(std::size_t i, double sound) {
  const Fault& fault = faults_[i];
  State& state = states_[i];
  const auto back = [&](std::size_t ticks) {  // 1: the last before this one
    return state.past.empty() ? sound : state.past[state.past.size() - std::min(ticks, state.past.size())];
  };
  double value = sound;
  if (state.shows) {
    const auto ms = static_cast<std::size_t>(std::lround(fault.value));
    const double since_s = static_cast<double>(state.ticks) * kTick_s;
    if (state.shown_ticks == 0) {
      state.replay.clear();
      const std::size_t kept = fault.kind == FaultKind::Replay ? ms : 1;
      for (std::size_t k = kept; k >= 1; --k) state.replay.push_back(back(k));
    }
    switch (fault.kind) {
      case FaultKind::Frozen:
      case FaultKind::Replay:
        value = state.replay[static_cast<std::size_t>(state.shown_ticks) % state.replay.size()];
        break;
      case FaultKind::Offset:
        value += fault.value;
        break;
      case FaultKind::Scale:
        value *= fault.value;
        break;
      case FaultKind::Drift:
        value += fault.value * since_s;
        break;
      case FaultKind::Lag:
        value = back(ms);
        break;
      case FaultKind::Quantised:
        value = std::round(value / fault.value) * fault.value;
        break;
      case FaultKind::Inverted:
        value = -value;
        break;
      case FaultKind::OtherSurface:
        value = fault.value;
        break;
      case FaultKind::Oscillation:
        value += fault.value * std::sin(2.0 * std::numbers::pi * kOscillation_Hz * since_s);
        break;
      case FaultKind::MissingPolarity:
        if (value * fault.value > 0.0) value = 0.0;
        break;
      case FaultKind::Command:
        value = asked_V_;
        break;
      case FaultKind::Dropout:
      case FaultKind::Noise:
        break;
    }
    if (fault.noise > 0.0) value += fault.noise * normals(seed_, (draws_++ << 5U) + i).first;
  }
  state.past.push_back(sound);
  if (state.past.size() > kPast_ticks) state.past.pop_front();
  return value;
}

drivers::SensorReading FaultyStage::read() {
  update_activity();
  drivers::SensorReading reading = sound_.read();
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    switch (faults_[i].signal) {
      case FaultSignal::Depth:
        reading.laser_code = to_count(shown(i, reading.depth_um * 1e-3) * 1e3);
        reading.depth_um = reading.laser_code;
        if (is_lost(i)) reading.laser_valid = false;
        break;
      case FaultSignal::DepthB:
        reading.depth_b_um = to_count(shown(i, reading.depth_b_um * 1e-3) * 1e3);
        if (is_lost(i)) reading.laser_b_valid = false;
        break;
      case FaultSignal::VoltageMonitor:
        reading.monitor_mV = to_count(shown(i, reading.monitor_mV * 1e-3) * 1e3);
        if (is_lost(i)) reading.monitor_mV = 0;
        break;
      case FaultSignal::CurrentMonitor:
        reading.current_nA = to_count(shown(i, reading.current_nA * 1e-9) * 1e9);
        if (is_lost(i)) reading.current_nA = 0;
        break;
      default:
        break;
    }
  }
  return reading;
}

std::int32_t FaultyStage::write(const safety::GatedVoltage& voltage) {
  asked_V_ = voltage.hv_enabled() ? voltage.mV() * 1e-3 : 0.0;
  double volts = voltage.mV() * 1e-3;
  double grips = voltage.brake_on() ? 1.0 : 0.0, holding = 1.0;
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    if (faults_[i].signal == FaultSignal::Drive) {
      volts = shown(i, volts);
      if (is_lost(i)) volts = 0.0;
    } else if (faults_[i].signal == FaultSignal::Brake && faults_[i].kind == FaultKind::Scale) {
      if (states_[i].shows) holding *= std::max(0.0, faults_[i].value);
    } else if (faults_[i].signal == FaultSignal::Brake) {
      grips = shown(i, grips);
      if (is_lost(i)) grips = 0.0;
    }
  }
  if (armed_ticks_ >= 0 || voltage.hv_enabled()) ++armed_ticks_;
  // A disabled amplifier gives nothing, whatever its input does.
  sound_.put_out(voltage.hv_enabled() ? volts : 0.0, grips > 0.5, holding);
  return voltage.mV();
}

}  // namespace biopsy::sim
