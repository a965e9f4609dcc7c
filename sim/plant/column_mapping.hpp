// Which column of a CSV holds which quantity, and in what unit: the table [columns] of dataset.toml.
//
//   [columns]
//   time         = { name = "t", unit = "ms" }
//   displacement = { name = "laser", unit = "um", sign = -1 }
//
// A quantity that the table omits is read from its own column (time_s, voltage_V, ...).
#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "robot/common/files/csv_table.hpp"
#include "robot/common/files/toml_reader.hpp"

namespace biopsy::sim {

struct Quantity {
  std::string_view name;    // key in [columns]
  std::string_view column;  // where there is no entry, with its unit
  double si_per_unit;       // of that column
  double low, high;         // in that unit
};

inline constexpr std::array kQuantities{Quantity{"time", "time_s", 1.0, -1e9, 1e9},
                                        Quantity{"voltage", "voltage_V", 1.0, -20e3, 20e3},
                                        Quantity{"force", "force_N", 1.0, -1e5, 1e5},
                                        Quantity{"displacement", "displacement_mm", 1e-3, -1e5, 1e5},
                                        Quantity{"plate_b", "plate_b_mm", 1e-3, -1e5, 1e5},
                                        Quantity{"current", "current_uA", 1e-6, -1e7, 1e7},
                                        Quantity{"external_force", "external_force_N", 1.0, -1e5, 1e5}};

class ColumnMapping {
 public:
  // Adds the entries of [columns] in `table`, if it has one; they replace earlier ones. Throws ConfigError
  // for an unknown quantity, unit or key.
  void read(TomlTable& table);

  bool has(const CsvTable& csv, std::string_view quantity) const;
  // SI. Throws ConfigError where the column is missing, or a number is out of range.
  std::vector<double> values(const CsvTable& csv, std::string_view quantity) const;
  // Throws ConfigError for a column that holds a quantity in another unit, or text.
  void check_other_columns(const CsvTable& csv) const;

 private:
  struct Source {
    std::string column;
    double si_per_unit = 1.0;  // sign and factor included
  };
  Source source(std::string_view quantity) const;

  std::map<std::string, Source, std::less<>> sources_;
};

// Throws ConfigError where `table` has `right` (weight_g) in another unit (weight_kg).
void refuse_wrong_unit(const TomlTable& table, std::string_view right, std::string_view stem);

}  // namespace biopsy::sim
