// The simulated stage with faults between it and the rest of the robot: readings and drive are changed, the
// plant behind them goes on as physics has it.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "sim/faults/fault.hpp"
#include "sim/simulated_stage.hpp"

namespace biopsy::sim {

class FaultyStage final : public drivers::NeedleStage {
 public:
  // `sound` must outlive this.
  FaultyStage(SimulatedStage& sound, std::vector<Fault> faults, std::uint64_t seed);

  drivers::SensorReading read() override;
  std::int32_t write(const safety::GatedVoltage& voltage) override;

  const std::vector<Fault>& faults() const { return faults_; }
  // Of faults()[i], in the tick of the last read(): it began and has not ended.
  std::uint32_t active_faults() const;                          // bit i
  bool shows(std::size_t i) const { return states_[i].shows; }  // and this tick is not a pause of it

 private:
  // What one fault remembers of its signal.
  struct State {
    bool active = false, ended = false, shows = false;
    std::int64_t ticks = 0;        // since it began
    std::int64_t shown_ticks = 0;  // since it last began to show
    std::deque<double> past;       // sound values, newest last: a second at most
    std::vector<double> replay;    // as captured when it last began to show
  };

  void update_activity();
  double shown(std::size_t i, double sound);
  bool is_lost(std::size_t i);
  double drawn(std::size_t i);

  SimulatedStage& sound_;
  std::vector<Fault> faults_;
  std::vector<State> states_;
  std::uint64_t seed_, draws_ = 0;
  double asked_V_ = 0.0;           // of the amplifier
  std::int64_t armed_ticks_ = -1;  // since high voltage was first enabled; -1: not yet
};

}  // namespace biopsy::sim
