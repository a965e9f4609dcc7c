#include "robot/procedure/case/controller_file.hpp"

#include <fmt/format.h>

#include "robot/common/files/toml_reader.hpp"

namespace biopsy::robot {
namespace {

constexpr double kVolts =
    1e3;  // in a kilovolt; and the ticks in a second, so that a file's K_i is the loop's

double proportional(const PiGains& gains) {
  return gains.proportional_V_per_mm / kVolts;
}

}  // namespace

PiGains read_controller(TomlTable table) {
  return {
      .proportional_V_per_mm = kVolts * table.number("K_p_kV_per_mm", proportional(kLeastGains),
                                                     proportional(kMostGains), "kV/mm"),
      .integral_V_per_mm_per_tick = table.number("K_i_kV_per_mm_s", kLeastGains.integral_V_per_mm_per_tick,
                                                 kMostGains.integral_V_per_mm_per_tick, "kV/(mm s)")};
}

PiGains read_controller_file(const std::filesystem::path& file) {
  return read_toml(file, [](TomlTable& root) {
    if (root.has("title")) root.text("title");
    return read_controller(root.table("controller"));
  });
}

std::string controller_toml(const PiGains& gains, const std::string& title) {
  return fmt::format(
      "title = {}\n\n[controller]\nK_p_kV_per_mm = {:.4g}\nK_i_kV_per_mm_s = {:.4g}  # K_i of 1 kV/(mm s) "
      "is 0.001 kV/mm at each 1 ms tick\n",
      quoted(title), proportional(gains), gains.integral_V_per_mm_per_tick);
}

}  // namespace biopsy::robot
