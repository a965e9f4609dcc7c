// Examination of a data set before anything is fitted to it.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "sim/gap/gap_finding.hpp"
#include "sim/plant/dataset.hpp"
#include "sim/plant/plant_model.hpp"

namespace biopsy::sim::gap {

// What is wrong with the recording; remarks that block the search first. Nothing is changed: each sentence
// says what to write in dataset.toml. `noise` [m]: of one reading, as the search takes it.
std::vector<DataRemark> examine(const Dataset& dataset, const PlantModel& model, double noise);

// By the readings alone (channels.cpp): constant, missing, frozen, clipped, quantised, single outliers,
// copied runs.
std::vector<DataRemark> examine_channels(const Dataset& dataset, Drive drive, double noise);

// With the model (misread.cpp): units wrong by powers of ten, sign, exchanged columns or runs, time scale and
// offset. A run is misread where one such change makes the model reproduce a motion that it misses otherwise.
std::vector<DataRemark> examine_with_model(const Dataset& dataset, const PlantModel& model, double noise);

// Whether nothing further can be read from the channel.
inline bool is_unusable(const DataRemark& remark) {
  return remark.cause == "constant" || remark.cause == "copied" || remark.cause == "missing";
}

// Smallest difference that all readings are multiples of; 0 where there is none. m
double quantisation_step(const std::vector<double>& readings);

// Largest minus smallest.
inline double range_of(const std::vector<double>& values) {
  const auto [smallest, largest] = std::ranges::minmax(values);
  return largest - smallest;
}

// "run a" or "runs a, b"; "all runs" where it is all of them.
std::string run_list(const std::vector<std::string>& runs, std::size_t of);

}  // namespace biopsy::sim::gap
