#include "sim/plant/column_mapping.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "robot/common/config_error.hpp"

namespace biopsy::sim {
namespace {

struct UnitSymbol {
  std::string_view symbol;
  double si;
};

constexpr std::array kTimeUnits{UnitSymbol{"s", 1.0}, UnitSymbol{"ms", 1e-3}, UnitSymbol{"us", 1e-6},
                                UnitSymbol{"min", 60.0}};
constexpr std::array kVoltageUnits{UnitSymbol{"V", 1.0}, UnitSymbol{"kV", 1e3}, UnitSymbol{"mV", 1e-3}};
constexpr std::array kForceUnits{UnitSymbol{"N", 1.0}, UnitSymbol{"mN", 1e-3}, UnitSymbol{"kN", 1e3},
                                 UnitSymbol{"gf", 9.80665e-3}, UnitSymbol{"kgf", 9.80665}};
constexpr std::array kLengthUnits{UnitSymbol{"mm", 1e-3}, UnitSymbol{"um", 1e-6}, UnitSymbol{"nm", 1e-9},
                                  UnitSymbol{"cm", 1e-2}, UnitSymbol{"m", 1.0},   UnitSymbol{"in", 25.4e-3}};
constexpr std::array kCurrentUnits{UnitSymbol{"uA", 1e-6}, UnitSymbol{"nA", 1e-9}, UnitSymbol{"mA", 1e-3},
                                   UnitSymbol{"A", 1.0}};

std::span<const UnitSymbol> units_of(std::string_view quantity) {
  if (quantity == "time") return kTimeUnits;
  if (quantity == "voltage") return kVoltageUnits;
  if (quantity == "current") return kCurrentUnits;
  if (quantity == "displacement" || quantity == "plate_b") return kLengthUnits;
  return kForceUnits;
}

const Quantity& quantity_of(std::string_view name) {
  return *std::ranges::find(kQuantities, name, &Quantity::name);
}

double si_of(TomlTable& entry, std::string_view quantity, double otherwise) {
  if (!entry.has("unit")) return otherwise;
  const std::string symbol = entry.text("unit");
  const auto units = units_of(quantity);
  const auto found = std::ranges::find(units, symbol, &UnitSymbol::symbol);
  if (found != units.end()) return found->si;
  std::vector<std::string_view> known;
  for (const UnitSymbol& unit : units) known.push_back(unit.symbol);
  entry.refuse("unit", fmt::format("= \"{}\" is no unit of {}", symbol, quantity),
               fmt::format("use one of {}", fmt::join(known, ", ")));
}

double sign_of(TomlTable& entry) {
  if (!entry.has("sign")) return 1.0;
  const double sign = entry.number("sign", -1.0, 1.0);
  if (std::abs(sign) != 1.0) entry.refuse("sign", "is neither 1 nor -1", "write sign = -1 to turn it");
  return sign;
}

// `name` is the quantity `stem` in another unit than that of `right`: refused, or it would be ignored.
bool in_wrong_unit(std::string_view name, std::string_view right, std::string_view stem) {
  return name != right && name.starts_with(std::string(stem) + "_") &&
         name.find('_', stem.size() + 1) == std::string_view::npos;
}

}  // namespace

void ColumnMapping::read(TomlTable& table) {
  if (!table.has("columns")) return;
  TomlTable columns = table.table("columns");
  for (const Quantity& quantity : kQuantities) {
    if (!columns.has(quantity.name)) continue;
    Source source{std::string(quantity.column), quantity.si_per_unit};
    if (!columns.holds_table(quantity.name)) {
      source.column = columns.text(quantity.name);
    } else {
      TomlTable entry = columns.table(quantity.name);
      if (entry.has("name")) source.column = entry.text("name");
      source.si_per_unit = si_of(entry, quantity.name, quantity.si_per_unit) * sign_of(entry);
      if (entry.has("factor")) source.si_per_unit *= entry.number("factor", 1e-9, 1e9);
    }
    sources_[std::string(quantity.name)] = source;
  }
}

ColumnMapping::Source ColumnMapping::source(std::string_view quantity) const {
  const auto mapped = sources_.find(quantity);
  if (mapped != sources_.end()) return mapped->second;
  const Quantity& own = quantity_of(quantity);
  return {std::string(own.column), own.si_per_unit};
}

bool ColumnMapping::has(const CsvTable& csv, std::string_view quantity) const {
  return sources_.contains(quantity) || csv.has(source(quantity).column);
}

std::vector<double> ColumnMapping::values(const CsvTable& csv, std::string_view quantity) const {
  const Source from = source(quantity);
  if (!csv.has(from.column))
    throw ConfigError(
        fmt::format("column `{}` is missing", from.column), csv.header_place(),
        fmt::format("the file has {}; needed are time_s, voltage_V (force_N with drive = \"force\") and "
                    "displacement_mm, or say in dataset.toml which column it is: [columns] {} = {{ name = "
                    "\"...\", unit = \"...\" }}",
                    fmt::join(csv.names(), ", "), quantity));
  const Quantity& own = quantity_of(quantity);
  const double scale = std::abs(from.si_per_unit / own.si_per_unit);
  std::vector<double> out = csv.numbers(from.column, own.low / scale, own.high / scale);
  for (double& value : out) value *= from.si_per_unit;
  return out;
}

void ColumnMapping::check_other_columns(const CsvTable& csv) const {
  constexpr double kAny = std::numeric_limits<double>::max();
  for (const std::string_view name : csv.names()) {
    const auto is_source = [&](const auto& one) { return one.second.column == name; };
    if (std::ranges::any_of(sources_, is_source)) continue;
    for (const Quantity& quantity : kQuantities)
      if (!sources_.contains(quantity.name) && in_wrong_unit(name, quantity.column, quantity.name))
        throw ConfigError(fmt::format("column `{}` has the wrong unit", name), csv.header_place(),
                          fmt::format("convert it and name it `{}`, or give its unit in dataset.toml: "
                                      "[columns] {} = {{ name = \"{}\", unit = \"...\" }}",
                                      quantity.column, quantity.name, name));
    if (std::ranges::find(kQuantities, name, &Quantity::column) == kQuantities.end())
      csv.numbers(name, -kAny, kAny);
  }
}

void refuse_wrong_unit(const TomlTable& table, std::string_view right, std::string_view stem) {
  for (const std::string& name : table.names())
    if (in_wrong_unit(name, right, stem))
      throw ConfigError(fmt::format("`{}` has the wrong unit", name), table.place(name),
                        fmt::format("convert it and name it `{}`", right));
}

}  // namespace biopsy::sim
