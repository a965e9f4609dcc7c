#include "robot/procedure/recheck.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <future>

#include "planner/plan/insertion_steps.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/files/temporary_folder.hpp"
#include "sim/plant/model_text.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;

constexpr const char* kReferencePlans[] = {"gap", "liver"};  // the paper's two biopsies (Fig. 13)

// What the planner assumes when it places stops (planner/plan/insertion_steps.hpp): final and settled error
// of the loop, and the distance to a boundary.
constexpr double kFinalError_mm = 0.1, kSettledError_mm = 0.07;
constexpr double kOvershoot_mm = planner::kStopShort.value;
constexpr double kMostNoise_mm = 1.0;  // a model file allows no more

std::vector<PreparedCase> prepared_plans(const fs::path& folder) {
  std::vector<PreparedCase> out;
  for (const char* name : kReferencePlans) {
    out.push_back(prepare(read_case(name), folder / name));
    if (const auto* refusal = std::get_if<PlanRefusal>(&out.back().plan))
      throw ConfigError("the built-in case is refused: " + refusal->what, name, refusal->remedy);
  }
  return out;
}

// The model with sensor noise, which every real laser has.
fs::path with_noise(const fs::path& file, double noise_mm, const fs::path& copy) {
  sim::NotedModel model = sim::read_noted_model(file);
  std::optional<sim::SensorNoise>& noise = model.model.effects.sensor_noise;
  if (noise && noise->std > 0.0) return file;
  noise = sim::SensorNoise{.std = std::min(noise_mm, kMostNoise_mm) * 1e-3};
  atomic_write(copy, sim::model_toml(model.model, model.notes));
  return copy;
}

std::vector<report::RunRecord> rehearsed(std::vector<PreparedCase> plans, const fs::path& model,
                                         const fs::path& folder, const Progress& progress) {
  std::vector<report::RunRecord> out;
  for (std::size_t i = 0; i < plans.size(); ++i) {
    plans[i].given.rehearsal.model = model;
    out.push_back(rehearse(plans[i], folder / kReferencePlans[i], progress));
    out.back().samples = {};  // only the figures are used
  }
  return out;
}

bool completed(const report::RunRecord& run) {
  return run.outcome == report::Outcome::Completed;
}

// A procedure that did not complete counts as one stop, even without a supervisor trip: the depth check may
// have rejected.
double unplanned_stops(const report::RunRecord& run) {
  return std::max(static_cast<double>(run.trips.size()), completed(run) ? 0.0 : 1.0);
}

double final_error(const report::RunRecord& run) {
  return std::abs(run.final_depth_mm - run.plan->target_depth.value);
}

void compare(const std::string& plan, const report::RunRecord& old_run, const report::RunRecord& new_run,
             Recheck& out) {
  const auto add = [&](const std::string& quantity, const std::string& unit, double limit, double before,
                       double after) {
    if (std::isfinite(after))
      out.margins.push_back({plan, quantity, unit, limit, before, after, after <= limit});
  };
  add("unplanned stops", "", 0.0, unplanned_stops(old_run), unplanned_stops(new_run));
  add("final depth error", "mm", kFinalError_mm, final_error(old_run), final_error(new_run));
  add("settled depth error (rms)", "mm", kSettledError_mm, old_run.rmse_settled_mm, new_run.rmse_settled_mm);
  add("overshoot", "mm", kOvershoot_mm, old_run.overshoot_mm, new_run.overshoot_mm);
  for (const report::LimitUse& limit : new_run.limits) {
    const auto before = std::ranges::find(old_run.limits, limit.name, &report::LimitUse::name);
    const bool used = before != old_run.limits.end();  // not of a lock where it ended before one
    add(limit.name, limit.unit, limit.limit, used ? before->used : 0.0, limit.used);
  }
  for (const auto& [run, model] : {std::pair{&old_run, "old"}, std::pair{&new_run, "new"}})
    if (!completed(*run))
      out.warnings.push_back(fmt::format(
          "The dry-run of plan {} with the {} model ended early: {}. Its figures are those of the "
          "run until then.",
          plan, model, run->refusal));
}

}  // namespace

Recheck recheck(const fs::path& old_model, const fs::path& new_model, double noise_mm,
                const Progress& progress) {
  const TemporaryFolder scratch("free some space there, set TMPDIR to another folder, or give --no-recheck");
  const fs::path old_file = with_noise(old_model, noise_mm, scratch.path() / "old.toml");
  const fs::path new_file = with_noise(new_model, noise_mm, scratch.path() / "new.toml");
  const std::vector<PreparedCase> plans = prepared_plans(scratch.path());
  // Rehearsals share only what they read.
  auto old_runs = std::async(std::launch::async, [&] {
    return rehearsed(plans, old_file, scratch.path() / "old", [](double, const std::string&) {});
  });
  const std::vector<report::RunRecord> after = rehearsed(plans, new_file, scratch.path() / "new", progress);
  const std::vector<report::RunRecord> before = old_runs.get();
  Recheck out;
  for (std::size_t i = 0; i < after.size(); ++i) compare(kReferencePlans[i], before[i], after[i], out);
  if (new_file != new_model)
    out.warnings.push_back(fmt::format(
        "The model has no [effect.sensor_noise]. The dry-runs of this report used "
        "{:.3g} mm, the noise floor; any other dry-run with this model is stopped, because a depth "
        "that never changes counts as a broken sensor (R-19).",
        noise_mm));
  return out;
}

}  // namespace biopsy::robot
