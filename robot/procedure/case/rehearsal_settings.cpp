#include "robot/procedure/case/rehearsal_settings.hpp"

#include "robot/common/config_error.hpp"
#include "robot/common/files/toml_reader.hpp"

namespace biopsy::robot {
namespace {

sim::NeedleBody read_needle(TomlTable table) {
  sim::NeedleBody needle;
  if (table.has("susceptibility_ppm"))
    needle.susceptibility_ppm =
        table.number("susceptibility_ppm", -sim::kSusceptibilityMax_ppm, sim::kSusceptibilityMax_ppm, "ppm");
  if (table.has("material")) {
    if (table.has("susceptibility_ppm"))
      table.refuse("material", "beside susceptibility_ppm", "keep one of them");
    needle.susceptibility_ppm = sim::needle_material(table.text("material")).susceptibility_ppm;
  }
  if (table.has("diameter_mm")) needle.diameter = Millimetres(table.number("diameter_mm", 0.2, 5.0, "mm"));
  if (table.has("tip_length_mm"))
    needle.tip_length = Millimetres(table.number("tip_length_mm", 0.0, 20.0, "mm"));
  if (table.has("length_mm")) needle.shaft_length = Millimetres(table.number("length_mm", 4.0, 1000.0, "mm"));
  sim::refuse_bad_needle(needle, table.where());
  return needle;
}

// Exactly one of two words.
bool is_first(TomlTable& table, const char* name, const std::string& first, const std::string& second) {
  const std::string text = table.text(name);
  if (text != first && text != second)
    table.refuse(name, "is neither \"" + first + "\" nor \"" + second + "\"", "choose one of them");
  return text == first;
}

sim::Sequence read_sequence(TomlTable table) {
  using Sequence = sim::Sequence;
  Sequence out;
  if (table.has("echo"))
    out.echo = is_first(table, "echo", "gradient", "spin") ? Sequence::Echo::Gradient : Sequence::Echo::Spin;
  if (table.has("field_T")) out.b0_T = table.number("field_T", 0.05, 15.0, "T");
  if (table.has("field_direction_ras")) {
    const std::vector<double> ras = table.numbers("field_direction_ras", -1.0, 1.0);
    if (ras.size() != 3) table.refuse("field_direction_ras", "does not hold three numbers", "give R, A, S");
    out.b0_S = lps_from_ras({ras[0], ras[1], ras[2]});
  }
  if (table.has("echo_time_ms")) out.echo_time_ms = table.number("echo_time_ms", 0.0, 200.0, "ms");
  if (table.has("bandwidth_Hz_per_pixel"))
    out.bandwidth_Hz_per_pixel = table.number("bandwidth_Hz_per_pixel", 10.0, 1e5, "Hz");
  if (table.has("read_axis")) out.read_axis = is_first(table, "read_axis", "row", "column") ? 0 : 1;
  if (table.has("read_reversed")) out.read_reversed = table.flag("read_reversed");
  if (table.has("slice_bandwidth_Hz"))
    out.slice_bandwidth_Hz = table.number("slice_bandwidth_Hz", 0.0, 1e5, "Hz");
  if (table.has("slice_thickness_mm"))
    out.slice_thickness_mm = table.number("slice_thickness_mm", 0.0, 50.0, "mm");
  if (table.has("slice_profile"))
    out.profile = is_first(table, "slice_profile", "box", "gaussian") ? Sequence::Profile::Box
                                                                      : Sequence::Profile::Gaussian;
  sim::refuse_bad_sequence(out, table.where());
  return out;
}

}  // namespace

void read_rehearsal(TomlTable table, const std::filesystem::path& file, Rehearsal& out) {
  const auto beside = [&](const std::string& path) { return file.parent_path() / path; };
  if (table.has("model")) out.model = beside(table.text("model"));
  if (table.has("tissues")) out.tissues = beside(table.text("tissues"));
  if (table.has("scan_s")) out.scan = Seconds(table.number("scan_s", kScanMin_s, kScanMax_s, "s"));
  if (table.has("snr")) out.snr = table.number("snr", 1.0, 1000.0);
  if (table.has("patient_shift_mm")) out.motion_mm = table.number("patient_shift_mm", 0.0, 50.0, "mm");
  if (table.has("patient_turn_deg")) out.motion_deg = table.number("patient_turn_deg", 0.0, 45.0, "degrees");
  if (table.has("coil_shading")) out.coil_shading = table.number("coil_shading", 0.0, 0.9);
  if (table.has("ghost")) out.ghost = table.number("ghost", 0.0, 1.0);
  if (table.has("ghost_shift_voxels"))
    out.ghost_shift_voxels = static_cast<int>(table.whole_number("ghost_shift_voxels", 4096));
  if (table.has("sequence")) out.sequence = read_sequence(table.table("sequence"));
  if (table.has("needle")) out.needle = read_needle(table.table("needle"));
}

}  // namespace biopsy::robot
