// Stages to be commissioned: the simulated bench, and the NI-DAQmx driver on the fake board, each with an
// operator.
#pragma once

#include <optional>
#include <set>
#include <string>

#include "drivers/commissioning/run_steps.hpp"
#include "drivers/nidaqmx/pulse_line.hpp"
#include "robot/bench/commissioning_operator.hpp"
#include "robot/bench/commissioning_rig.hpp"
#include "tests/drivers/nidaqmx/fake_board_config.hpp"

namespace biopsy::commissioning {

// Confirms everything but what it refuses.
class SilentOperator final : public Operator {
 public:
  void notify(const std::string&) override {}
  bool confirm(Act act, const std::string&) override { return !refuses.contains(act); }
  std::optional<double> enter_value(const std::string&) override { return std::nullopt; }

  std::set<Act> refuses;
};

inline sim::PlantModel quiet_model() {
  sim::PlantModel model;
  model.effects.sensor_noise = sim::SensorNoise{.std = 10e-6};
  return model;
}

struct SimulatedCommissioning {
  robot::SimulatedBench bench{quiet_model(), 1};
  robot::SupervisedRig rig{bench, bench.connections()};
  SilentOperator operator_;
  robot::SimulatedOperator simulated{bench, operator_, false};

  Record run() { return run_steps({}, rig, simulated); }
};

// Acts on the fake board.
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

  std::optional<double> block_mm;  // as typed; none: the true height

 private:
  fake::Board& board_;
};

struct Laboratory {
  explicit Laboratory(nidaqmx::Config with = nidaqmx::laboratory()) : config(std::move(with)) {}

  Record run() {
    robot::StageConnections connections;
    connections.feed_interlock = [this](bool feeding) { stage.feed_interlock(feeding); };
    if (stage.has_panel())
      connections.estop = [this] {
        return robot::StageConnections::Contacts{stage.panel().estop_a_closed, stage.panel().estop_b_closed};
      };
    connections.supervisor_pulse = &supervisor_pulse;
    robot::SupervisedRig rig(stage, connections);
    return run_steps({}, rig, operator_);
  }

  fake::Board& board = *fake_reset();
  nidaqmx::Config config;
  nidaqmx::NidaqmxStage stage{config, fake_now_us};
  nidaqmx::PulseLine supervisor_pulse{config};
  BoardOperator operator_{board};
};

// The last step, and the first of its figures outside its limits.
inline std::string ended_by(const Record& record) {
  const StepRecord& last = record.steps.back();
  for (const Figure& figure : last.figures)
    if (!figure.ok()) return last.name + ": " + figure.what;
  return "passed";
}

inline std::string text_of(const Record& record) {
  std::string text;
  for (const StepRecord& step : record.steps) text += step.name + "\n" + to_text(step) + "\n";
  return text;
}

}  // namespace biopsy::commissioning
