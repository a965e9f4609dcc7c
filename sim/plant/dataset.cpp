#include "sim/plant/dataset.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "robot/common/config_error.hpp"
#include "robot/common/files/csv_table.hpp"
#include "robot/common/files/toml_reader.hpp"
#include "sim/plant/column_mapping.hpp"
#include "sim/plant/recording/row_times.hpp"

namespace biopsy::sim {
namespace {

double number_or(TomlTable& table, std::string_view name, double low, double high, double otherwise) {
  return table.has(name) ? table.number(name, low, high) : otherwise;
}

bool is_with_tissue(TomlTable& root) {
  const std::string set_up = root.text("set_up");
  if (set_up != "bench" && set_up != "tissue")
    root.refuse("set_up", fmt::format("= \"{}\" is unknown", set_up),
                "write \"bench\" where the needle meets no tissue, or \"tissue\"");
  return set_up == "tissue";
}

RunRole role_of(TomlTable& entry) {
  const std::string role = entry.text("role");
  if (role != "train" && role != "test")
    entry.refuse("role", fmt::format("= \"{}\" is unknown", role), "write \"train\" or \"test\"");
  return role == "train" ? RunRole::Train : RunRole::Test;
}

// Readings on straight lines between the time stamps; inputs are held, as they were.
void to_fixed_rate(RecordedRun& run, double period) {
  const std::vector<double> stamps = run.time;
  for (std::vector<double>* held : {&run.input, &run.external_force})
    *held = resampled(stamps, *held, period, true);
  for (std::vector<double>* read : {&run.displacement, &run.plate_b, &run.current})
    if (!read->empty()) *read = resampled(stamps, *read, period, false);
  run.time.clear();
  for (std::size_t row = 0; row < run.input.size(); ++row)
    run.time.push_back(stamps.front() + static_cast<double>(row) * period);
  run.period = period;
}

RecordedRun read_run(const std::filesystem::path& folder, TomlTable entry, Drive drive, ColumnMapping columns,
                     bool resample) {
  RecordedRun run;
  run.name = entry.text("name");
  run.file = entry.text("file");
  if (run.file.empty() || std::filesystem::path(run.file).has_parent_path())
    throw ConfigError(fmt::format("file \"{}\" is not in the data set's folder", run.file), entry.where(),
                      "keep the CSV beside dataset.toml");
  refuse_wrong_unit(entry, "weight_g", "weight");
  refuse_wrong_unit(entry, "external_force_N", "external_force");
  run.weight = number_or(entry, "weight_g", 0.0, 1e5, 0.0) * 1e-3;
  if (entry.has("role")) run.role = role_of(entry);
  columns.read(entry);
  const double push = number_or(entry, "external_force_N", -1e5, 1e5, 0.0);
  const CsvTable table = read_csv(folder / run.file);
  columns.check_other_columns(table);
  run.time = columns.values(table, "time");
  run.input = columns.values(table, drive == Drive::Force ? "force" : "voltage");
  run.displacement = columns.values(table, "displacement");
  if (columns.has(table, "plate_b")) run.plate_b = columns.values(table, "plate_b");
  if (columns.has(table, "current")) run.current = columns.values(table, "current");
  run.external_force.assign(run.time.size(), 0.0);
  if (columns.has(table, "external_force")) run.external_force = columns.values(table, "external_force");
  for (double& force : run.external_force) force += push;
  if (resample)
    to_fixed_rate(run, usual_period(table, run.time));
  else
    run.period = fixed_period(table, run.time);
  return run;
}

// Either no run has a role, or all have and both occur.
void check_roles(const Dataset& dataset, const std::string& file) {
  const auto count = [&](RunRole role) { return std::ranges::count(dataset.runs, role, &RecordedRun::role); };
  const auto none = static_cast<std::size_t>(count(RunRole::Unassigned));
  if (none == dataset.runs.size()) return;
  if (none > 0 || count(RunRole::Train) == 0 || count(RunRole::Test) == 0)
    throw ConfigError("`role` is given for some of the runs, or is the same for all", file,
                      "give each run a role: at least one \"train\" and one \"test\"");
}

}  // namespace

Dataset read_dataset(const std::filesystem::path& folder, Drive drive) {
  const std::filesystem::path file = folder / "dataset.toml";
  if (std::filesystem::is_regular_file(folder))
    throw ConfigError("a file, where a folder is meant", folder.string(),
                      "give the folder that holds dataset.toml and its CSV files");
  if (!std::filesystem::exists(file))
    throw ConfigError("no dataset.toml", folder.string(),
                      "give the folder that holds dataset.toml and its CSV files");
  Dataset dataset = read_toml(file, [&](TomlTable& root) {
    Dataset read;
    refuse_wrong_unit(root, "sensor_noise_mm", "sensor_noise");
    if (root.has("title")) read.title = root.text("title");
    if (root.has("sensor_noise_mm")) read.sensor_noise = root.number("sensor_noise_mm", 0.0, 100.0) * 1e-3;
    if (root.has("set_up")) read.tissue = is_with_tissue(root);
    ColumnMapping columns;
    columns.read(root);
    const bool resample = root.has("resample") && root.flag("resample");
    for (const TomlTable& entry : root.tables("run"))
      read.runs.push_back(read_run(folder, entry, drive, columns, resample));
    return read;
  });
  check_roles(dataset, file.string());
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
