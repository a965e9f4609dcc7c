// A sealed plan for the bench: the stage alone, open loop, no patient and no needle. What the supervisor
// holds an experiment to.
#pragma once

#include <string>
#include <variant>

#include "robot/msg/plan.hpp"

namespace biopsy::planner {

struct BenchRequest {
  std::string what;           // of the run, for a person; sealed with the plan
  Grams weight;               // on the fixture
  Volts highest;              // amplitude the run may reach, and the plan's limit
  Seconds half_period{0.25};  // of the square wave
  double drive_scale = 1.0;   // how many times the nominal voltage this stage needs for a depth
};

// How deep such a stage goes at most in such a run: the nominal one, under so many times the voltage.
Millimetres expected_travel(const BenchRequest& request);

inline constexpr double kDriveScaleMax = 3.0;  // with 8 kV, 2.67 kV nominal: 6.5 mm with 50 g

// One step over the whole stroke with the run's own voltage as limit: a stage that is not known yet may go
// anywhere within its stroke. So every depth from 1 mm below rest to the stroke is plausible at any drive
// (R-21, R-27 and R-32 do not judge it), all other limits stand. Refused where such a stage
// would come nearer than 1 mm to the end of the stroke, above 8 kV, or with a weight that is not modelled.
std::variant<Plan, PlanRefusal> plan_bench(const BenchRequest& request);

}  // namespace biopsy::planner
