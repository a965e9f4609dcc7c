// The bytes of a plan under their own seal, as a process that may write plans could send them: opened only
// if they are the one form of that plan, and what the supervisor is told of it is judged, whatever it says.
#include "planner/plan/open_plan.hpp"
#include "planner/plan/seal.hpp"
#include "robot/cycle/plan_facts.hpp"
#include "tests/verification/fuzz/target.hpp"

FUZZ(plan) {
  using namespace biopsy;
  using namespace biopsy::fuzz;
  const std::optional<Plan> plan = planner::open_plan(bytes, sha256(std::as_bytes(bytes)));
  if (!plan) return;
  claim(std::ranges::equal(planner::canonical_bytes(*plan), bytes), "one plan, one form");
  reads_or_refuses([&] {
    const safety::PlanFacts facts = robot::plan_facts(*plan, 1);
    safety::plausible_depth(facts, 0, 8'000'000);
    claim(!safety::is_plausible(facts) || plan->limits.depth_max.value < 100.0,
          "kilometres do not become millimetres");
  });
}
