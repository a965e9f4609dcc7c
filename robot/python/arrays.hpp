// Between numpy and the product: arrays of numbers, checked for shape, type and finite values.
#pragma once

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robot/common/config_error.hpp"

namespace biopsy::python {

namespace py = pybind11;

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

// numpy would drop what is imaginary or masked without an error, and read numbers out of texts.
template <class Wanted>
Wanted real_array(const py::object& given, const std::string& name) {
  const py::array any = py::array::ensure(given);
  if (!any) PyErr_Clear();
  if (!any || std::string_view("fiub").find(any.dtype().kind()) == std::string_view::npos)
    throw ConfigError("holds other than real numbers", name, "give an array of numbers");
  if (py::module_::import("numpy.ma").attr("is_masked")(given).cast<bool>())
    throw ConfigError("has masked values", name, "cut them out, or fill them");
  return Wanted::ensure(any);
}

// Of so many rows and columns; one column: an array of one dimension.
template <int Rows, int Columns>
Eigen::Matrix<double, Rows, Columns> fixed_numbers(const py::object& given, const std::string& name) {
  const auto values = real_array<Array>(given, name);
  const bool fits = Columns == 1
                        ? values.ndim() == 1 && values.shape(0) == Rows
                        : values.ndim() == 2 && values.shape(0) == Rows && values.shape(1) == Columns;
  if (!fits)
    throw ConfigError(fmt::format("is not {}", Columns == 1 ? fmt::format("{} numbers", Rows)
                                                            : fmt::format("{} x {} numbers", Rows, Columns)),
                      name, "check its shape");
  Eigen::Matrix<double, Rows, Columns> matrix;
  for (int row = 0; row < Rows; ++row)
    for (int column = 0; column < Columns; ++column)
      matrix(row, column) = values.data()[row * Columns + column];
  return matrix;
}

// `scale`: from the unit of the array to the unit wanted. `rows`: that it must have; empty: two at least.
inline std::vector<double> numbers(const py::object& given, const std::string& name, double scale = 1.0,
                                   std::optional<std::size_t> rows = {}) {
  const auto array = real_array<Array>(given, name);
  if (array.ndim() != 1)
    throw ConfigError(fmt::format("has {} dimensions", array.ndim()), name, "give an array of one dimension");
  std::vector<double> values(array.data(), array.data() + array.size());
  if (rows && values.size() != *rows)
    throw ConfigError(fmt::format("has {} values where there are {} rows", values.size(), *rows), name,
                      "give arrays of one length");
  if (values.size() < 2) throw ConfigError("has fewer than two values", name, "give a longer record");
  const auto bad = std::find_if_not(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  if (bad != values.end())
    throw ConfigError(fmt::format("value {} is not a finite number", bad - values.begin()), name,
                      "cut the record there, or leave the run out");
  for (double& value : values) value *= scale;
  return values;
}

inline Array array(const std::vector<double>& values, double scale = 1.0) {
  Array result(static_cast<py::ssize_t>(values.size()));
  std::transform(values.begin(), values.end(), result.mutable_data(), [&](double v) { return v * scale; });
  return result;
}

// NaN, which stands for an unknown number, as None.
inline py::object known(double value) {
  return std::isfinite(value) ? py::object(py::float_(value)) : py::object(py::none());
}

inline double in_range(double value, double low, double high, const std::string& name,
                       const std::string& unit) {
  if (!(value >= low && value <= high))
    throw ConfigError(fmt::format("{} is outside {:g} to {:g} {}", value, low, high, unit), name,
                      "check its unit");
  return value;
}

// As on the command line: what JSON and TOML keep exactly.
inline std::optional<std::uint64_t> seed_of(std::optional<double> seed) {
  if (!seed) return std::nullopt;
  if (!(*seed >= 0.0 && *seed <= 9e15 && std::floor(*seed) == *seed))
    throw ConfigError(fmt::format("{} is no whole number from 0 to 9e15", *seed), "seed", "give another");
  return static_cast<std::uint64_t>(*seed);
}

}  // namespace biopsy::python
