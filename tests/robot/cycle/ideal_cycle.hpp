// A plan, an ideal stage and a watch over what each function of a cycle is given.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "planner/plan/seal.hpp"
#include "robot/cycle/plan_facts.hpp"
#include "robot/cycle/run_cycle.hpp"
#include "tests/robot/cycle/small_plan.hpp"

namespace biopsy::robot {

inline constexpr std::uint64_t kConfigOfCycle = 77;

inline Plan plan_of_two_steps(double first_mm = 2.0) {
  return small_plan({first_mm, 3.0}, {{Volts(0), Millimetres(-0.5), Millimetres(3.5)},
                                      {Volts(8000), Millimetres(-0.5), Millimetres(6.0)}});
}

using Order = std::vector<std::string>;

struct IdealStage final : drivers::NeedleStage {
  Order* order = nullptr;
  std::int32_t written_mV = 0, most_mV = 8'000'000;  // of its converter
  std::int64_t time_us = 0;
  std::int32_t code = 0, depth_um = 0;

  drivers::SensorReading read() override {
    if (order != nullptr) order->emplace_back("read");
    time_us += 1'000;
    return {.time_us = time_us,
            .depth_um = depth_um,
            .laser_code = ++code,
            .laser_valid = true,
            .depth_b_um = depth_um,
            .laser_b_valid = true,
            .monitor_mV = written_mV,
            .brake_fitted = true};
  }
  std::int32_t write(const safety::GatedVoltage& voltage) override {
    if (order != nullptr) order->emplace_back("write");
    return written_mV = std::clamp(voltage.mV(), -most_mV, most_mV);
  }
};

// Keeps what each function is given, and changes it where a test wants that.
struct Watch final : FaultHooks {
  Order* order = nullptr;
  safety::SupervisorInputs supervised;
  safety::Evidence decided;
  GateInputs gated;
  bool loses_permit = false, trip = false;

  void before_monitors(safety::SupervisorInputs& inputs) override {
    if (order != nullptr) order->emplace_back("supervise");
    supervised = inputs;
  }
  void before_decision(safety::SupervisorInputs&, safety::Evidence& evidence) override {
    decided = evidence;
    if (trip) evidence.clear &= ~safety::bit(safety::Hazard::Arc);
  }
  void before_gate(GateInputs& inputs) override {
    if (order != nullptr) order->emplace_back("gate");
    gated = inputs;
    if (loses_permit) inputs.permit = {};
  }
};

}  // namespace biopsy::robot
