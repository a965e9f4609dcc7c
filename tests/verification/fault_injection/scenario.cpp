#include "tests/verification/fault_injection/scenario.hpp"

#include <array>
#include <string>
#include <variant>

#include "planner/plan/plan_insertion.hpp"
#include "planner/plan/registration.hpp"
#include "robot/cycle/plan_facts.hpp"
#include "sim/plant/model_file.hpp"

namespace biopsy::fault_injection {
namespace {

void vary(Draw& draw, double& value, double share) {
  value *= draw.within(1.0 - share, 1.0 + share);
}

// How stages of one kind differ: pouches and films by a few per cent, guides and dampers by more.
void vary_stage(Draw& draw, sim::PlantModel& plant) {
  vary(draw, plant.baseline.K, 0.01);
  vary(draw, plant.baseline.tau, 0.10);
  vary(draw, plant.baseline.eps_film, 0.03);
  vary(draw, plant.baseline.d_film, 0.01);
  vary(draw, plant.baseline.V0, 0.03);
  vary(draw, plant.baseline.tau_h, 0.10);
  vary(draw, plant.baseline.k, 0.05);
  vary(draw, plant.baseline.c_s, 0.20);
  vary(draw, plant.effects.charge_retention->share, 0.30);
  vary(draw, plant.effects.charge_retention->time, 0.30);
  vary(draw, plant.effects.film_hysteresis->loss, 0.30);
  vary(draw, plant.effects.hysteretic_spring->stiffness, 0.20);
  vary(draw, plant.effects.sensor_lag->time, 0.20);
  vary(draw, plant.effects.sensor_noise->std, 0.30);
}

// Specimens differ by more than stages do.
void vary_tissue(Draw& draw, sim::TissueLayer& layer) {
  vary(draw, layer.surface.force, 0.30);
  vary(draw, layer.surface.cutting, 0.30);
  vary(draw, layer.surface.deflection, 0.20);
  vary(draw, layer.shaft.coulomb, 0.30);
  vary(draw, layer.shaft.viscous, 0.30);
  vary(draw, layer.relaxation.stiffness, 0.30);
}

std::vector<Layer> draw_layers(Draw& draw) {
  constexpr std::array kNames{"muscle", "fat", "liver", "gap", "unknown"};
  std::vector<Layer> layers;
  Millimetres from(0.0);
  const std::int32_t count = draw.whole(1, 3);
  for (std::int32_t i = 0; i < count; ++i) {
    const Millimetres to = i + 1 == count ? Millimetres(20.0) : from + Millimetres(draw.within(0.9, 2.5));
    std::string name = kNames[static_cast<std::size_t>(draw.whole(0, kNames.size() - 1))];
    if (!layers.empty() && layers.back().name == name) name = name == "fat" ? "muscle" : "fat";
    layers.push_back({name, from, to});
    from = to;
  }
  return layers;
}

planner::InsertionRequest draw_request(Draw& draw, const planner::NominalStage& nominal) {
  planner::InsertionRequest request;
  request.stage = nominal;
  const double depth_mm = draw.within(2.5, 5.0);
  request.target.patient_id = "P" + std::to_string(draw.whole(1, 9999));
  request.target.series_uid = "1.2.826.0." + std::to_string(draw.whole(1, 99999));
  request.target.p_ST = Point(0, 0, depth_mm);
  request.X_SR = planner::needle_pose(request.target.p_SE, request.target.p_ST);
  request.layers = draw_layers(draw);
  request.weight = Grams(draw.within(40.0, 70.0));
  if (draw.coin()) {
    request.staging = planner::Staging::AsGiven;
    request.waypoints = {Millimetres(depth_mm * draw.within(0.45, 0.7))};
  }
  request.pace.speed = MillimetresPerSecond(draw.within(0.8, 1.5));
  request.pace.crossing = MillimetresPerSecond(draw.within(0.4, 0.7));
  request.pace.dwell = Seconds(draw.within(0.3, 1.0));
  return request;
}

}  // namespace

NominalModels read_nominal_models(const std::filesystem::path& models) {
  return {sim::read_model(models / "calibrated.toml"), true,
          planner::read_nominal_stage(models / "calibrated.toml"),
          sim::read_tissues(models / "tissues.toml")};
}

Scenario draw_scenario(const NominalModels& models, std::uint64_t seed) {
  Draw draw(seed);
  while (true) {
    const planner::InsertionRequest request = draw_request(draw, models.nominal);
    auto planned = planner::plan_insertion(request);
    if (!std::holds_alternative<Plan>(planned)) continue;  // refused with a reason: nothing to rehearse
    Scenario scenario;
    scenario.plan = std::get<Plan>(std::move(planned));
    scenario.facts = robot::plan_facts(scenario.plan, 1 + draw.bits() % 1'000'000);
    scenario.plant = models.stage;
    scenario.plant.weight = request.weight.value * 1e-3;
    if (models.varies) {
      // Most faults show in a needle that is free; those of the brake have classes of their own.
      scenario.plant.brake.reset();
      vary_stage(draw, scenario.plant);
    }
    scenario.plant.tissue = sim::tissue_along(scenario.plan.layers, models.tissues);
    for (sim::TissueLayer& layer : scenario.plant.tissue) vary_tissue(draw, layer);
    scenario.noise_seed = draw.bits();
    return scenario;
  }
}

}  // namespace biopsy::fault_injection
