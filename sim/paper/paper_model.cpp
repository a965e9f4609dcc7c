#include "sim/paper/paper_model.hpp"

#include <numbers>

#include "robot/common/files/toml_reader.hpp"
#include "sim/plant/baseline_entries.hpp"
#include "sim/plant/model_file.hpp"
#include "sim/tissue/tissue.hpp"

namespace biopsy::sim::paper {
namespace {

double of_baseline(TomlTable& table, std::string_view name) {
  const BaselineEntry& entry = *baseline_entry(name);
  return table.number(name, entry.low, entry.high);
}

Film read_film(TomlTable table) {
  Film film;
  film.K = of_baseline(table, "K");
  film.tau = of_baseline(table, "tau");
  film.eps_film = of_baseline(table, "eps_film");
  film.d_film = of_baseline(table, "d_film");
  return film;
}

Joint read_joint(TomlTable table) {
  Joint joint;
  joint.mass = 1e-3 * table.number("mass_g", 0.0, 1000.0);
  joint.friction = table.number("friction_N", 0.0, 10.0);
  joint.crank = 1e-3 * table.number("crank_mm", 1.0, 1000.0);
  joint.start = table.number("start_deg", -90.0, 90.0) * std::numbers::pi / 180.0;
  return joint;
}

Needle read_needle(TomlTable table, const TissueTable& tissues) {
  const double muscle_mm = table.number("muscle_mm", 0.1, 100.0), gap_mm = table.number("gap_mm", 0.0, 100.0);
  const std::vector<Layer> path{{"muscle", Millimetres(0.0), Millimetres(muscle_mm)},
                                {"gap", Millimetres(muscle_mm), Millimetres(muscle_mm + gap_mm)},
                                {"liver", Millimetres(muscle_mm + gap_mm), Millimetres(1e3)}};
  Needle needle;
  needle.muscle = 1e-3 * muscle_mm;
  needle.liver = 1e-3 * (muscle_mm + gap_mm);
  needle.tissue = tissue_along(path, tissues);
  return needle;
}

}  // namespace

PaperModel read_paper_model(const std::filesystem::path& stage, const std::filesystem::path& paper) {
  PaperModel model;
  model.name = stage.filename().string();
  model.stage = read_model(stage);
  return read_toml(paper, [&](TomlTable& root) {
    root.ignore("title");
    TomlTable films = root.table("film");
    model.pi25 = read_film(films.table("pi25"));
    model.bopp25 = read_film(films.table("bopp25"));
    model.joint = read_joint(root.table("joint"));
    model.needle = read_needle(root.table("needle"), read_tissues(paper.parent_path() / "tissues.toml"));
    return model;
  });
}

PlantModel with_film(PlantModel stage, const Film& film) {
  stage.baseline.K = film.K;
  stage.baseline.tau = film.tau;
  stage.baseline.eps_film = film.eps_film;
  stage.baseline.d_film = film.d_film;
  stage.effects.charge_retention.reset();
  return stage;
}

}  // namespace biopsy::sim::paper
