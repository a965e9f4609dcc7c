// plan_and_simulate MODEL.toml DEPTH_MM: plans an insertion through two layers, then drives the simulated
// plant with the voltage that the planner's own model asks for at that depth, and compares.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>

#include "planner/plan/nominal_model.hpp"
#include "planner/plan/plan_insertion.hpp"
#include "planner/plan/registration.hpp"
#include "robot/common/config_error.hpp"
#include "sim/plant/model_file.hpp"
#include "sim/plant/plant.hpp"

namespace {

using namespace biopsy;

int run(const char* model_file, double depth_mm) {
  planner::InsertionRequest request;  // points in the scanner's LPS, mm
  request.target.p_SE = Point(0, 0, 0);
  request.target.p_ST = Point(0, 0, -depth_mm);
  request.X_SR = planner::needle_pose(request.target.p_SE, request.target.p_ST);
  request.layers = {{"muscle", Millimetres(0.0), Millimetres(2.0)},
                    {"liver", Millimetres(2.0), Millimetres(15.0)}};
  request.stage = planner::read_nominal_stage(model_file);
  const auto planned = planner::plan_insertion(request);
  if (const auto* refused = std::get_if<PlanRefusal>(&planned)) {
    std::printf("refused: %s\nto do: %s\n", refused->what.c_str(), refused->remedy.c_str());
    return 3;
  }
  const Plan& plan = std::get<Plan>(planned);
  for (const InsertionStep& step : plan.steps)
    std::printf("step to %.2f mm at %.2f mm/s, at most %.2f kV: %s\n", step.depth.value, step.speed.value,
                step.v_max.value * 1e-3, step.why.c_str());

  const std::optional<Volts> drive =
      planner::NominalModel(request.weight, request.stage).drive(plan.target_depth);
  if (!drive) return std::printf("the stage does not reach that depth\n"), 3;
  sim::PlantModel model = sim::read_model(model_file);
  model.weight = request.weight.value * 1e-3;
  sim::PlantState state = sim::at_rest(model);
  constexpr double kTick_s = 1e-3, kHalfPeriod_s = 0.25;  // the square wave of 2 Hz
  for (int tick = 0; tick < 10'000; ++tick) {
    const bool positive = std::fmod(tick * kTick_s, 2 * kHalfPeriod_s) < kHalfPeriod_s;
    state = sim::step(model, state, {.voltage = positive ? drive->value : -drive->value}, Seconds(kTick_s));
  }
  std::printf("%.2f kV: planned %.2f mm, the simulated stage in air stands at %.2f mm\n", drive->value * 1e-3,
              plan.target_depth.value, sim::displacement_reading(model, state) * 1e3);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return std::fprintf(stderr, "usage: plan_and_simulate MODEL.toml DEPTH_MM\n"), 2;
  try {
    return run(argv[1], std::atof(argv[2]));
  } catch (const ConfigError& error) {
    std::fprintf(stderr, "error: %s\nwhere: %s\nto do: %s\n", error.what_is_wrong.c_str(),
                 error.where.c_str(), error.remedy.c_str());
    return 2;
  }
}
