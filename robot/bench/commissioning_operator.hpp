// Operators of commissioning: at a terminal, and simulated where the stage is.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>

#include "drivers/commissioning/rig.hpp"
#include "robot/bench/commissioning_rig.hpp"
#include "safety/interlock.hpp"
#include "sim/simulated_stage.hpp"

namespace biopsy::robot {

// Asks "done? [y/n]" and for numbers; the end of the input counts as no.
class TerminalOperator final : public commissioning::Operator {
 public:
  TerminalOperator(std::istream& in, std::ostream& out) : in_(in), out_(out) {}

  void notify(const std::string& what) override;
  bool confirm(commissioning::Act act, const std::string& what) override;
  std::optional<double> enter_value(const std::string& what) override;

 private:
  std::istream& in_;
  std::ostream& out_;
};

// The simulated stage on a bench: with the interlock of safety/interlock.hpp, an emergency stop with two
// contacts, and a force on plate A.
class SimulatedBench final : public drivers::NeedleStage {
 public:
  explicit SimulatedBench(const sim::PlantModel& model, std::uint64_t seed);

  drivers::SensorReading read() override { return stage_.read(); }
  std::int32_t write(const safety::GatedVoltage& voltage) override;

  StageConnections connections();
  void lift(double force_N) { stage_.push(-force_N); }
  double true_depth_mm() const { return stage_.truth().motion.x * 1e3; }
  void press_estop_under_voltage() { press_at_ = kPressAfter_ticks; }
  void release_estop() { press_at_.reset(), pressed_ticks_ = 0; }

 private:
  static constexpr int kPressAfter_ticks = 300;  // under voltage
  static constexpr int kContactLag_ticks = 2;    // between the contacts of a real button

  struct SupervisorsHalf final : drivers::PulseOutput {
    explicit SupervisorsHalf(SimulatedBench& bench) : bench_(bench) {}
    void pulse() override {
      bench_.interlock_ = safety::feed_from_supervisor(bench_.interlock_, bench_.stage_.now_us());
    }
    SimulatedBench& bench_;
  };

  sim::SimulatedStage stage_;
  safety::Interlock interlock_;
  SupervisorsHalf supervisors_half_{*this};
  bool feeding_ = true;
  std::optional<int> press_at_;
  int pressed_ticks_ = 0;
};

// Acts on the simulated bench once `terminal` has confirmed, or at once if `always_agrees`.
class SimulatedOperator final : public commissioning::Operator {
 public:
  SimulatedOperator(SimulatedBench& bench, commissioning::Operator& terminal, bool always_agrees)
      : bench_(bench), terminal_(terminal), always_agrees_(always_agrees) {}

  void notify(const std::string& what) override { terminal_.notify(what); }
  bool confirm(commissioning::Act act, const std::string& what) override;
  std::optional<double> enter_value(const std::string& what) override;

 private:
  SimulatedBench& bench_;
  commissioning::Operator& terminal_;
  bool always_agrees_;
};

}  // namespace biopsy::robot
