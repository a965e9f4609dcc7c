#include "robot/console/review/run_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "robot/common/config_error.hpp"
#include "robot/common/files/csv_table.hpp"
#include "robot/report/procedure/labels.hpp"

namespace biopsy::console {
namespace {

constexpr const char* kRemedy = "give the folder of a run as `biopsy dry-run` or the console wrote it";

struct Column {
  const char* name;
  double low, high;  // in the unit of its name; what the messages of the bus can hold
  bool optional = false;
};
constexpr double kLength_mm = 1e7, kVoltage_kV = 1e4, kStep = 255;
constexpr std::array kNumbers{
    Column{"time_s", 0.0, 1e6},
    Column{"displacement_mm", -kLength_mm, kLength_mm},
    Column{"setpoint_mm", -kLength_mm, kLength_mm},
    Column{"voltage_V", -1e3 * kVoltage_kV, 1e3 * kVoltage_kV},
    Column{"envelope_kV", -kVoltage_kV, kVoltage_kV},
    Column{"monitor_kV", -kVoltage_kV, kVoltage_kV},
    Column{"current_uA", -1e7, 1e7},
    Column{"tip_mm", -kLength_mm, kLength_mm, true},
    Column{"plate_b_mm", -kLength_mm, kLength_mm, true},
    Column{"locked", 0.0, 1.0, true},  // not in files of before the brake
};
constexpr std::array kNames{"mode", "stop", "stage", "gate"};

void check_columns(const CsvTable& table) {
  for (const Column& column : kNumbers)
    if (!column.optional && !table.has(column.name))
      throw ConfigError(fmt::format("column `{}` is missing", column.name), table.header_place(), kRemedy);
  for (const char* name : kNames)
    if (!table.has(name))
      throw ConfigError(fmt::format("column `{}` is missing", name), table.header_place(), kRemedy);
  for (const std::string_view name : table.names()) {
    const bool known =
        std::any_of(kNumbers.begin(), kNumbers.end(), [&](const Column& one) { return one.name == name; }) ||
        std::find(kNames.begin(), kNames.end(), name) != kNames.end();
    if (!known)
      throw ConfigError(fmt::format("column `{}` is not known", name.substr(0, 40)), table.header_place(),
                        kRemedy);
  }
}

template <class Enumeration>
Enumeration named(const CsvTable& table, const char* column, std::size_t row) {
  const std::string_view name = table.text(column, row);
  const auto value = report::labelled<Enumeration>(name);
  if (!value)
    throw ConfigError(fmt::format("column `{}`: there is no \"{}\"", column, name.substr(0, 40)),
                      table.place(row), kRemedy);
  return *value;
}

std::vector<review::Span> spans_of(const CsvTable& table, const std::vector<double>& time) {
  const std::vector<double> step = table.numbers("stage", 1, kStep);
  std::vector<review::Span> spans;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    named<GateVerdict>(table, "gate", row);
    const review::Span now{time[row], named<Mode>(table, "mode", row),
                           named<StopCategory>(table, "stop", row), static_cast<std::uint32_t>(step[row])};
    if (spans.empty() || spans.back().mode != now.mode || spans.back().stop != now.stop ||
        spans.back().step != now.step)
      spans.push_back(now);
  }
  return spans;
}

}  // namespace

RunTable parse_run_table(std::string text, const std::string& file_name) {
  const CsvTable table = CsvTable::parse(std::move(text), file_name);
  check_columns(table);
  if (table.rows() > kRowsMax)
    throw ConfigError(fmt::format("{} rows; a page shows at most {}", table.rows(), kRowsMax), file_name,
                      "cut the file into parts");
  RunTable run;
  for (const Column& column : kNumbers) {
    if (!table.has(column.name)) continue;
    run.columns.emplace_back(column.name);
    run.values.push_back(table.numbers(column.name, column.low, column.high));
  }
  const std::vector<double>& time = run.values.front();
  const auto back = std::adjacent_find(time.begin(), time.end(), std::greater<>());
  if (back != time.end())
    throw ConfigError("column `time_s`: time runs back",
                      table.place(static_cast<std::size_t>(back - time.begin()) + 1), kRemedy);
  run.spans = spans_of(table, time);
  return run;
}

}  // namespace biopsy::console
