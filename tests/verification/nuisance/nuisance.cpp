// Hours of healthy procedures on the virtual clock: no trip and no unrequested stop.
#include <algorithm>

#include "tests/kept_figures.hpp"
#include "tests/source_dir.hpp"
#include "tests/verification/evidence_program.hpp"
#include "tests/verification/nuisance/drawn_stages.hpp"
#include "tests/verification/nuisance/healthy_procedures.hpp"

namespace {

using namespace biopsy::fault_injection;

biopsy::EvidenceReport report_of(const HealthyRun& day, double seconds) {
  biopsy::EvidenceReport report{.passed = day.alarms.empty() && day.trips == 0 && day.unexpected_stops == 0,
                                .figures = {{"simulated_hours", day.hours},
                                            {"procedures", day.procedures},
                                            {"completed", day.completed},
                                            {"given_up", day.given_up},
                                            {"stages", day.steps},
                                            {"releases", day.releases},
                                            {"trips", day.trips},
                                            {"unexpected_holds", day.unexpected_stops},
                                            {"punctures_held", day.punctures_held},
                                            {"needles_held", day.needles_held},
                                            {"borne_out", day.borne_out},
                                            {"not_completed", day.procedures - day.completed - day.given_up},
                                            {"seconds", seconds}}};
  report.tables["alarms"] = nlohmann::json::array();
  for (const Alarm& alarm : day.alarms)
    report.tables["alarms"].push_back(
        {{"stage", alarm.stage}, {"procedure", alarm.procedure}, {"at_s", alarm.at_s}, {"what", alarm.what}});
  return report;
}

std::vector<std::string> row_of(const HealthyRun& all, std::size_t stages) {
  std::vector<std::string> row{std::to_string(stages), fmt::format("{:.0f}", all.hours)};
  for (const int count : {all.procedures, all.completed, all.given_up, all.trips, all.unexpected_stops,
                          all.borne_out, all.needles_held})
    row.push_back(std::to_string(count));
  return row;
}

// Figures of all days together; each day's stage is another of `stages`.
biopsy::EvidenceReport run(double hours, std::uint64_t seed, int drawn, const std::string& keep) {
  NominalModels models = read_nominal_models(biopsy::source_dir() / "sim/models");
  std::vector<biopsy::sim::PlantModel> stages{models.stage};
  models.varies = drawn == 0;
  if (drawn > 0) stages = drawn_stages(biopsy::source_dir() / "sim/models/calibrated.toml", drawn, seed);
  const biopsy::Stopwatch time;
  HealthyRun all;
  for (std::size_t day = 0; day < stages.size(); ++day) {
    models.stage = stages[day];
    HealthyRun one = run_healthy_procedures(models, hours, seed + day, {}, [&](double share) {
      fmt::print(stderr, "\rhealthy procedures: stage {} of {}, {:3.0f} %", day + 1, stages.size(),
                 100.0 * std::min(share, 1.0));
    });
    for (Alarm& alarm : one.alarms) alarm.stage = day + 1;
    all = joined(std::move(all), one);
  }
  fmt::print(
      "\n{} {}, {:.2f} h, {} procedures ({} completed, {} given up), {} steps, {} releases: {} trips and {} "
      "unrequested stops, of which the plant bears {} out, {} holds after a puncture that truly jumped, {} "
      "needles that friction held at 0 V\n",
      stages.size(), stages.size() == 1 ? "stage" : "stages", all.hours, all.procedures, all.completed,
      all.given_up, all.steps, all.releases, all.trips, all.unexpected_stops, all.borne_out,
      all.punctures_held, all.needles_held);
  for (const Alarm& alarm : all.alarms)
    fmt::print("  stage {}, procedure {} at {:.2f} s: {}\n", alarm.stage, alarm.procedure, alarm.at_s,
               alarm.what);
  if (!keep.empty())
    biopsy::write_figures(
        "nuisance-drawn",
        {keep, "explanation/verification.md", "g++ " __VERSION__, {row_of(all, stages.size())}});
  return report_of(all, time.seconds());
}

}  // namespace

int main(int argc, char** argv) {
  double hours = 8.0;
  bool quick = false;
  std::uint64_t seed = 1;
  int drawn = 0;
  std::string keep;
  CLI::App app{"Hours of healthy procedures on the virtual clock: no trip and no unrequested stop"};
  app.add_flag("--quick", quick, "twenty minutes");
  app.add_option("--hours", hours, "of procedures")->check(CLI::Range(1e-3, 1'000.0));
  app.add_option("--seed", seed, "of all random choices");
  app.add_option("--drawn-stages", drawn, "so many stages of the calibration's posterior, each for the hours")
      ->check(CLI::Range(0, 1'000));
  app.add_option("--keep", keep, "keep the table for the documentation, as that of this command")
      ->needs("--drawn-stages");
  return biopsy::evidence_program("nuisance", app, argc, argv,
                                  [&] { return run(quick ? 1.0 / 3.0 : hours, seed, drawn, keep); });
}
