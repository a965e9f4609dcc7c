#include "sim/plant/dataset.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "robot/common/config_error.hpp"
#include "robot/common/files/csv_table.hpp"
#include "robot/common/files/toml_reader.hpp"
#include "robot/common/statistics.hpp"

namespace biopsy::sim {
namespace {

struct ColumnRule {
  std::string_view name, stem;
  double low, high;  // file units
};

constexpr std::array kColumns{ColumnRule{"time_s", "time", -1e9, 1e9},
                              ColumnRule{"voltage_V", "voltage", -20e3, 20e3},
                              ColumnRule{"force_N", "force", -1e5, 1e5},
                              ColumnRule{"displacement_mm", "displacement", -1e5, 1e5},
                              ColumnRule{"plate_b_mm", "plate_b", -1e5, 1e5},
                              ColumnRule{"current_uA", "current", -1e7, 1e7},
                              ColumnRule{"external_force_N", "external_force", -1e5, 1e5}};

// `name` is the quantity `stem` in another unit than that of `right`: refused, or it would be ignored.
bool in_wrong_unit(std::string_view name, std::string_view right, std::string_view stem) {
  return name != right && name.starts_with(std::string(stem) + "_") &&
         name.find('_', stem.size() + 1) == std::string_view::npos;
}

// Columns that are not used must hold numbers all the same.
void check_columns(const CsvTable& table) {
  constexpr double kAny = std::numeric_limits<double>::max();
  for (const std::string_view name : table.names()) {
    for (const ColumnRule& rule : kColumns)
      if (in_wrong_unit(name, rule.name, rule.stem))
        throw ConfigError(fmt::format("column `{}` has the wrong unit", name), table.header_place(),
                          fmt::format("convert it and name it `{}`", rule.name));
    if (std::ranges::find(kColumns, name, &ColumnRule::name) == kColumns.end())
      table.numbers(name, -kAny, kAny);
  }
}

// The same for dataset.toml: weight_kg = 0.05 must not be ignored.
void refuse_wrong_units(const TomlTable& table, std::string_view right, std::string_view stem) {
  for (const std::string& name : table.names())
    if (in_wrong_unit(name, right, stem))
      throw ConfigError(fmt::format("`{}` has the wrong unit", name), table.place(name),
                        fmt::format("convert it and name it `{}`", right));
}

std::vector<double> column(const CsvTable& table, std::string_view name, double si_per_unit) {
  const auto& rule = *std::find_if(kColumns.begin(), kColumns.end(), [&](auto& r) { return r.name == name; });
  std::vector<double> out = table.numbers(name, rule.low, rule.high);
  for (double& value : out) value *= si_per_unit;
  return out;
}

void require(const CsvTable& table, std::string_view name) {
  if (!table.has(name))
    throw ConfigError(
        fmt::format("column `{}` is missing", name), table.header_place(),
        "columns: time_s,voltage_V,displacement_mm[,plate_b_mm][,current_uA][,external_force_N]; with drive "
        "= \"force\": time_s,force_N,displacement_mm");
}

// The fixed period of the rows; refuses anything else.
double period_of(const CsvTable& table, const std::vector<double>& time) {
  if (time.size() < 2)
    throw ConfigError("fewer than two rows", table.file(), "a run needs at least two samples");
  std::vector<double> steps;
  for (std::size_t i = 1; i < time.size(); ++i) {
    steps.push_back(time[i] - time[i - 1]);
    if (steps.back() <= 0.0)
      throw ConfigError(
          fmt::format("column `time_s`: time does not go on ({} s after {} s)", time[i], time[i - 1]),
          table.place(i), "sort the rows and remove repeated ones");
  }
  const double usual = median(steps);  // one gap must not make every other step look wrong
  for (std::size_t i = 0; i < steps.size(); ++i)
    // Printed times are rounded, often to a microsecond: a tenth of a period is a rounding, more is a gap.
    if (std::abs(steps[i] - usual) > std::max(0.1 * usual, 1.1e-6))
      throw ConfigError(
          fmt::format("column `time_s`: a step of {:.6g} s where the others take {:.6g} s", steps[i], usual),
          table.place(i + 1), "split the run at the gap or resample it at a fixed rate");
  const double period = (time.back() - time.front()) / static_cast<double>(steps.size());
  if (period < 0.99e-5 || period > 0.0505)
    throw ConfigError(fmt::format("sampled every {:.6g} s", period), table.file(),
                      "rates from 20 Hz to 100 kHz can be used");
  return period;
}

double number_or(TomlTable& table, std::string_view name, double low, double high, double otherwise) {
  return table.has(name) ? table.number(name, low, high) : otherwise;
}

RecordedRun read_run(const std::filesystem::path& folder, TomlTable entry, Drive drive) {
  RecordedRun run;
  run.name = entry.text("name");
  run.file = entry.text("file");
  if (run.file.empty() || std::filesystem::path(run.file).has_parent_path())
    throw ConfigError(fmt::format("file \"{}\" is not in the data set's folder", run.file), entry.where(),
                      "keep the CSV beside dataset.toml");
  refuse_wrong_units(entry, "weight_g", "weight");
  refuse_wrong_units(entry, "external_force_N", "external_force");
  run.weight = number_or(entry, "weight_g", 0.0, 1e5, 0.0) * 1e-3;
  const double push = number_or(entry, "external_force_N", -1e5, 1e5, 0.0);
  const CsvTable table = read_csv(folder / run.file);
  check_columns(table);
  const std::string_view input = drive == Drive::Force ? "force_N" : "voltage_V";
  for (const std::string_view name : {std::string_view("time_s"), input, std::string_view("displacement_mm")})
    require(table, name);
  run.time = column(table, "time_s", 1.0);
  run.period = period_of(table, run.time);
  run.input = column(table, input, 1.0);
  run.displacement = column(table, "displacement_mm", 1e-3);
  if (table.has("plate_b_mm")) run.plate_b = column(table, "plate_b_mm", 1e-3);
  if (table.has("current_uA")) run.current = column(table, "current_uA", 1e-6);
  run.external_force.assign(run.time.size(), 0.0);
  if (table.has("external_force_N")) run.external_force = column(table, "external_force_N", 1.0);
  for (double& force : run.external_force) force += push;
  return run;
}

}  // namespace

Dataset read_dataset(const std::filesystem::path& folder, Drive drive) {
  const std::filesystem::path file = folder / "dataset.toml";
  if (!std::filesystem::exists(file))
    throw ConfigError("no dataset.toml", folder.string(),
                      "give the folder that holds dataset.toml and its CSV files");
  Dataset dataset = read_toml(file, [&](TomlTable& root) {
    Dataset read;
    refuse_wrong_units(root, "sensor_noise_mm", "sensor_noise");
    if (root.has("title")) read.title = root.text("title");
    if (root.has("sensor_noise_mm")) read.sensor_noise = root.number("sensor_noise_mm", 0.0, 100.0) * 1e-3;
    for (const TomlTable& entry : root.tables("run")) read.runs.push_back(read_run(folder, entry, drive));
    return read;
  });
  if (dataset.runs.empty())
    throw ConfigError("no [[run]]", file.string(), "list at least one run with name and file");
  return dataset;
}

std::string run_csv(const RecordedRun& run, Drive drive) {
  fmt::memory_buffer out;
  auto to = std::back_inserter(out);
  fmt::format_to(to, "time_s,{},displacement_mm", drive == Drive::Force ? "force_N" : "voltage_V");
  if (!run.plate_b.empty()) fmt::format_to(to, ",plate_b_mm");
  if (!run.current.empty()) fmt::format_to(to, ",current_uA");
  fmt::format_to(to, ",external_force_N\n");
  for (std::size_t i = 0; i < run.time.size(); ++i) {
    fmt::format_to(to, "{:.6f},{:.9g},{:.6f}", run.time[i], run.input[i], run.displacement[i] * 1e3);
    if (!run.plate_b.empty()) fmt::format_to(to, ",{:.6f}", run.plate_b[i] * 1e3);
    if (!run.current.empty()) fmt::format_to(to, ",{:.6g}", run.current[i] * 1e6);
    fmt::format_to(to, ",{:.9g}\n", run.external_force[i]);
  }
  return fmt::to_string(out);
}

std::string dataset_toml(const Dataset& dataset) {
  fmt::memory_buffer text;
  auto to = std::back_inserter(text);
  fmt::format_to(to, "title = {}\n", quoted(dataset.title));
  if (dataset.sensor_noise) fmt::format_to(to, "sensor_noise_mm = {:.6f}\n", *dataset.sensor_noise * 1e3);
  for (const RecordedRun& run : dataset.runs)
    fmt::format_to(to, "\n[[run]]\nname = {}\nfile = {}\nweight_g = {:.6f}\n", quoted(run.name),
                   quoted(run.file), run.weight * 1e3);
  return fmt::to_string(text);
}

}  // namespace biopsy::sim
