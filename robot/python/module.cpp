// The Python package's compiled module: the product's own functions on numpy arrays.
#include "robot/common/config_error.hpp"
#include "robot/python/bindings.hpp"

namespace {

namespace py = pybind11;

void raise_input_error(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const biopsy::ConfigError& error) {
    const py::object type = py::module_::import("biopsy._errors").attr("InputError");
    const py::object raised = type(error.what_is_wrong, error.where, error.remedy);
    PyErr_SetObject(type.ptr(), raised.ptr());
  }
}

}  // namespace

PYBIND11_MODULE(_biopsy, module) {
  module.attr("__version__") = BIOPSY_VERSION;
  py::register_exception_translator(raise_input_error);
  biopsy::python::bind_plant(module);
  biopsy::python::bind_gap(module);
  biopsy::python::bind_images(module);
  biopsy::python::bind_robot(module);
}
