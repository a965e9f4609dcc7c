// Between numpy and the product: one-dimensional arrays of numbers, checked for length and finite values.
#pragma once

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "robot/common/config_error.hpp"

namespace biopsy::python {

namespace py = pybind11;

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

// `scale`: from the unit of the array to the unit wanted. `rows`: that it must have; empty: two at least.
inline std::vector<double> numbers(const Array& array, const std::string& name, double scale = 1.0,
                                   std::optional<std::size_t> rows = {}) {
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

}  // namespace biopsy::python
