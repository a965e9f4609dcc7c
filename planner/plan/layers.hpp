// The tissue the needle passes through, as layers along its path.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "robot/msg/plan.hpp"
#include "robot/msg/volume.hpp"

namespace biopsy::planner {

using LabelNames = std::map<int, std::string>;

// Layers from a label volume along p_SE + s * axis_S, s from 0 to `length` (LPS mm). Nearest label;
// neighbours of one label merge; slivers thinner than half a voxel along the path are an artefact of the grid
// and go to their neighbours. Boundaries are exact to 1 um on the label grid, whose own truth is half a
// voxel. A label without a name becomes "label 7", 0 becomes "unlabelled". Throws ConfigError where the path
// leaves the volume or a label is no whole number.
std::vector<Layer> layers_along_path(const Volume& labels, const Point& p_SE, const Direction& axis_S,
                                     Millimetres length, const LabelNames& names);

// What is wrong with a table of layers, as a sentence; empty if nothing: it must start at 0, rise without gap
// or overlap, and name each layer.
std::string layer_fault(const std::vector<Layer>& layers);

// The same for tables people write: throws ConfigError at `where`.
void check_layers(const std::vector<Layer>& layers, const std::string& where);

}  // namespace biopsy::planner
