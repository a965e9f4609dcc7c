// What the Python module is made of; one function for each room.
#pragma once

#include <pybind11/pybind11.h>

namespace biopsy::python {

void bind_plant(pybind11::module_& module);   // Model, Run, simulate, read_dataset
void bind_gap(pybind11::module_& module);     // gap
void bind_images(pybind11::module_& module);  // Image, read_image, check_depth
void bind_robot(pybind11::module_& module);   // plan, rehearse, Robot

}  // namespace biopsy::python
