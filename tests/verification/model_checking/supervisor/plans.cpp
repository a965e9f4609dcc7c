#include "tests/verification/model_checking/supervisor/plans.hpp"

#include <fmt/format.h>

namespace biopsy::model_checking {

NamedPlan three_steps(unsigned confirms) {
  const auto asks = [confirms](unsigned step) { return ((confirms >> step) & 1U) != 0; };
  safety::PlanFacts plan;
  plan.plan_tag = 0xB10B'0001;
  plan.config_tag = 0xC0F1'6001;
  plan.depth_max_um = 4'000;
  plan.step_count = 3;
  plan.steps[0] = {3'600, 6'500'000, 20'000, asks(0)};
  plan.steps[1] = {3'800, 7'000'000, 30'000, asks(1)};
  plan.steps[2] = {4'000, 7'500'000, 40'000, asks(2)};
  return {fmt::format("three steps, images confirm {}{}{}", asks(0) ? '1' : '-', asks(1) ? '2' : '-',
                      asks(2) ? '3' : '-'),
          plan};
}

NamedPlan over_limits() {
  NamedPlan plan = three_steps(0b010);
  plan.name = "steps that ask for more than the robot may do";
  plan.facts.steps[0] = {20'000, 20'000'000, 20'000'000, false};
  plan.facts.steps[1] = {3'800, -5, -5, true};
  return plan;
}

NamedPlan empty() {
  NamedPlan plan = three_steps(0);
  plan.name = "no step";
  plan.facts.step_count = 0;
  return plan;
}

std::vector<NamedPlan> all_plans() {
  std::vector<NamedPlan> plans;
  plans.push_back(three_steps(0b010));
  plans.back().grain = Grain::Full;
  plans.push_back(three_steps(0b101));
  plans.push_back(over_limits());
  plans.push_back(empty());
  for (const unsigned confirms : {0U, 1U, 3U, 4U, 6U, 7U}) {
    plans.push_back(three_steps(confirms));
    plans.back().grain = Grain::Thin;
  }
  return plans;
}

std::vector<NamedPlan> quick_plans() {
  return {three_steps(2), over_limits(), empty()};
}

}  // namespace biopsy::model_checking
