// The simulated needle stage: the plant behind the same port as the hardware. Writing a voltage advances it
// by one tick.
#pragma once

#include <cstdint>

#include "drivers/needle_stage.hpp"
#include "sim/plant/stepper.hpp"

namespace biopsy::sim {

// The amplifier's monitors and the laser's converter.
struct DeviceErrors {
  double monitor_noise = 0.001;  // share of the voltage, one standard deviation
  double current_noise_A = 20e-9;
  std::int32_t laser_code_um = 1;  // one converter code
};

class SimulatedStage final : public drivers::NeedleStage {
 public:
  SimulatedStage(const PlantModel& model, std::uint64_t seed, const DeviceErrors& errors = {});

  drivers::SensorReading read() override;
  std::int32_t write(const safety::GatedVoltage& voltage) override {
    put_out(voltage.mV() * 1e-3, voltage.brake_on());
    return voltage.mV();
  }

  // The next tick with these volts on the stack and this command of the brake, whoever asked for them: a
  // broken amplifier asks no gate. `holding`: share that a worn brake has of its force.
  void put_out(double volts, bool brake_on = false, double holding = 1.0);

  // Force down on plate A from the next write() on, N: a hand or a weight on the bench, without its inertia.
  void push(double force_N) { push_N_ = force_N; }

  // A person has plate A in the hand, at x (m), and lets go.
  void place(double x_m) { set_state(model_, state_, x_m, 0.0); }

  // True state, for reports and the simulated scanner.
  const PlantState& truth() const { return state_; }
  const PlantModel& model() const { return model_; }
  std::int64_t now_us() const { return now_us_; }

 private:
  PlantModel model_;
  Stepper stepper_;
  DeviceErrors errors_;
  std::uint64_t seed_;
  PlantState state_;
  void move_brake(bool on, double holding);

  std::int64_t now_us_ = 0;
  double push_N_ = 0.0;
  Grip grip_;
  double brake_s_ = 0.0;  // for how long it has been commanded to do what it does not do yet
};

}  // namespace biopsy::sim
