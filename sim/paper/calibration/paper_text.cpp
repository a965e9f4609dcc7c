#include "sim/paper/calibration/paper_text.hpp"

#include <fmt/format.h>

#include <numbers>

namespace biopsy::sim::calibration {
namespace {

using paper::Film;
using paper::PaperModel;

std::string line(const ModelNotes& notes, const std::string& table, const char* name, double value,
                 const char* source) {
  std::string text = fmt::format("{} = {{ value = {:.4g}", name, value);
  const auto note = notes.values.find(fmt::format("{}.{}", table, name));
  const bool noted = note != notes.values.end();
  if (noted && note->second.std) text += fmt::format(", std = {:.2g}", *note->second.std);
  return text + fmt::format(", source = \"{}\" }}\n", noted ? note->second.source.c_str() : source);
}

std::string film_text(const Film& film, const std::string& name, const char* permittivity,
                      const ModelNotes& notes) {
  const std::string table = "film." + name;
  return fmt::format("\n[{}]\n", table) +
         line(notes, table, "K", film.K, "C2 in proportion to eps_film/d_film against the stage's film") +
         line(notes, table, "tau", film.tau, "Fig. 6") +
         line(notes, table, "eps_film", film.eps_film, permittivity) +
         line(notes, table, "d_film", film.d_film, "twice 25 um, paper IV.A");
}

std::string joint_text(const paper::Joint& joint, const ModelNotes& notes) {
  return "\n[joint]\n" +
         line(notes, "joint", "mass_g", 1e3 * joint.mass, "assumed: the paper does not give the load") +
         line(notes, "joint", "friction_N", joint.friction, "assumed: of the order of the stage's own") +
         line(notes, "joint", "crank_mm", 1e3 * joint.crank,
              "Fig. 12: 8 mm turn the joint by 48.1 degrees, evenly about the middle") +
         line(notes, "joint", "start_deg", joint.start * 180.0 / std::numbers::pi,
              "the crank stands square to the slider in the middle of the travel");
}

}  // namespace

std::string paper_toml(const PaperModel& model, const ModelNotes& notes) {
  const paper::Needle& needle = model.needle;
  return std::string(
             "# What the paper's experiments need besides the stage (calibrated.toml): the films of the "
             "other\n"
             "# two materials of Fig. 6, and what hangs on the stage in Fig. 12 and 13. Written by `biopsy\n"
             "# calibrate`. SI units where no unit is in a name.\n"
             "title = \"Xiong, Zhou, Li, Yeow: films, joint and needle\"\n") +
         film_text(model.pi25, "pi25", "paper III.A", notes) +
         film_text(model.bopp25, "bopp25", "paper III.A: PI's 3.4 is about 50 % higher", notes) +
         joint_text(model.joint, notes) + "\n[needle]\n" +
         line(notes, "needle", "muscle_mm", 1e3 * needle.muscle, "paper IV.F.2: chicken of about 2 mm") +
         line(notes, "needle", "gap_mm", 1e3 * (needle.liver - needle.muscle), "paper IV.F.2");
}

}  // namespace biopsy::sim::calibration
