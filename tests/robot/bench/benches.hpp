// Stages to take into service: the simulated bench, and the laboratory's driver on the board that is not
// there; persons who do what they are asked, or do not.
#pragma once

#include <optional>
#include <set>
#include <string>

#include "drivers/commissioning/walk.hpp"
#include "drivers/nidaqmx/pulse_line.hpp"
#include "robot/bench/commissioning_operator.hpp"
#include "robot/bench/commissioning_rig.hpp"
#include "tests/drivers/nidaqmx/stage_in_hand.hpp"

namespace biopsy::commissioning {

// Hears everything, answers nothing: the other half of a simulated person.
class Listener final : public Operator {
 public:
  void notify(const std::string& what) override { heard += what + "\n"; }
  bool confirm(Act act, const std::string&) override { return !refuses.contains(act); }
  std::optional<double> enter_value(const std::string&) override { return std::nullopt; }

  std::string heard;
  std::set<Act> refuses;
};

inline sim::PlantModel quiet_model() {
  sim::PlantModel model;
  model.effects.sensor_noise = sim::SensorNoise{.std = 10e-6};
  return model;
}

// The simulated bench with everything that belongs to it.
struct SimulatedRoom {
  robot::SimulatedBench bench{quiet_model(), 1};
  robot::SupervisedRig rig{bench, bench.trimmings()};
  Listener listener;
  robot::SimulatedOperator operator_{bench, listener, false};

  Record walk() { return run_steps({}, rig, operator_); }
};

// Hands at the board that is not there.
class BoardOperator final : public Operator {
 public:
  explicit BoardOperator(fake::Board& board) : board_(board) {}

  void notify(const std::string&) override {}
  bool confirm(Act act, const std::string&) override {
    if (act == Act::LayBlock) board_.push_N = -0.56;
    if (act == Act::RemoveBlock) board_.push_N = 0.0;
    if (act == Act::PressEstopUnderVoltage) board_.press_under_voltage = 300;
    if (act == Act::ReleaseEstop) board_.press_under_voltage = 0, board_.contacts |= 0b1100U;
    return true;
  }
  std::optional<double> enter_value(const std::string&) override {
    return block_mm.value_or(board_.plant.motion.x * 1e3);
  }

  std::optional<double> block_mm;  // none: what it really is

 private:
  fake::Board& board_;
};

struct Laboratory {
  explicit Laboratory(nidaqmx::Config with = nidaqmx::laboratory()) : config(std::move(with)) {}

  Record walk() {
    robot::StageTrimmings trimmings;
    trimmings.feed_interlock = [this](bool feeding) { stage.feed_interlock(feeding); };
    if (stage.has_panel())
      trimmings.estop = [this] {
        return robot::StageTrimmings::Contacts{stage.panel().estop_a_closed, stage.panel().estop_b_closed};
      };
    trimmings.supervisor_pulse = &supervisors_half;
    robot::SupervisedRig rig(stage, trimmings);
    return run_steps({}, rig, operator_);
  }

  fake::Board& board = *fake_reset();
  nidaqmx::Config config;
  nidaqmx::NidaqmxStage stage{config, fake_now_us};
  nidaqmx::PulseLine supervisors_half{config};
  BoardOperator operator_{board};
};

// The step that ended a walk, and the first of its figures that is not right.
inline std::string ended_by(const Record& record) {
  const StepRecord& last = record.steps.back();
  for (const Figure& figure : last.figures)
    if (!figure.ok()) return last.name + ": " + figure.what;
  return "passed";
}

inline std::string told_all(const Record& record) {
  std::string text;
  for (const StepRecord& step : record.steps) text += step.name + "\n" + notify(step) + "\n";
  return text;
}

}  // namespace biopsy::commissioning
