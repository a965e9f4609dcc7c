#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "robot/common/files/data_folder.hpp"
#include "robot/python/arrays.hpp"
#include "robot/python/bindings.hpp"
#include "sim/plant/dataset.hpp"
#include "sim/plant/model_file.hpp"
#include "sim/plant/model_text.hpp"
#include "sim/plant/simulate.hpp"

namespace biopsy::python {
namespace {

using sim::RecordedRun;
using sim::RunRole;

constexpr double kShortest_s = 1e-5, kLongest_s = 0.05;  // between rows, as of a data set

sim::NotedModel model_from(const std::optional<std::filesystem::path>& file) {
  return sim::read_noted_model(file ? *file : data_folder() / "sim/models/calibrated.toml");
}

RunRole role_named(const std::string& role) {
  if (role.empty()) return RunRole::Unassigned;
  if (role == "train") return RunRole::Train;
  if (role == "test") return RunRole::Test;
  throw ConfigError(fmt::format("\"{}\" is no role", role), "role", "give \"train\", \"test\" or \"\"");
}

RecordedRun make_run(const py::object& input, const py::object& displacement_mm, double period_s,
                     double weight_g, const py::object& plate_b_mm, const py::object& current_uA,
                     const py::object& external_force_N, const std::string& name, const std::string& role) {
  RecordedRun run;
  run.name = name;
  run.file = name + ".csv";
  run.role = role_named(role);
  run.input = numbers(input, "input");
  const std::size_t rows = run.input.size();
  run.period = in_range(period_s, kShortest_s, kLongest_s, "period_s", "s");
  run.weight = in_range(weight_g, 0.0, 1e5, "weight_g", "g") * 1e-3;
  for (std::size_t row = 0; row < rows; ++row) run.time.push_back(static_cast<double>(row) * run.period);
  run.displacement = !displacement_mm.is_none() ? numbers(displacement_mm, "displacement_mm", 1e-3, rows)
                                                : std::vector<double>(rows, 0.0);
  if (!plate_b_mm.is_none()) run.plate_b = numbers(plate_b_mm, "plate_b_mm", 1e-3, rows);
  if (!current_uA.is_none()) run.current = numbers(current_uA, "current_uA", 1e-6, rows);
  run.external_force = !external_force_N.is_none() ? numbers(external_force_N, "external_force_N", 1.0, rows)
                                                   : std::vector<double>(rows, 0.0);
  return run;
}

py::object measured(const std::vector<double>& values, double scale) {
  return values.empty() ? py::object(py::none()) : py::object(array(values, scale));
}

}  // namespace

void bind_plant(py::module_& module) {
  py::class_<sim::NotedModel>(
      module, "Model", "A model of the stage: the paper's equations with the effects that are present.")
      .def_static(
          "parse", [](const std::string& text) { return sim::parse_noted_model(text, "model"); },
          py::arg("text"), "A model from the text of a model file (TOML).")
      .def(
          "text", [](const sim::NotedModel& m) { return sim::model_toml(m.model, m.notes); },
          "The model as text of a model file, which parse() reads back exactly.")
      .def_property_readonly(
          "title", [](const sim::NotedModel& m) { return m.notes.title; }, "Of the model file.")
      .def_property_readonly(
          "drive",
          [](const sim::NotedModel& m) {
            return m.model.baseline.drive == sim::Drive::Force ? "force" : "stack";
          },
          "\"stack\": the input is a voltage, V; \"force\": a force, N.")
      .def("__repr__",
           [](const sim::NotedModel& m) { return fmt::format("<biopsy.Model \"{}\">", m.notes.title); });

  py::class_<RecordedRun>(
      module, "Run",
      "A record at a fixed rate: row k is measured at k * period_s, then input[k] is applied "
      "and held until the next row. All arrays have one dimension and one length.")
      .def(
          py::init(&make_run), py::arg("input"), py::arg("displacement_mm") = py::none(), py::kw_only(),
          py::arg("period_s") = 1e-3, py::arg("weight_g") = 0.0, py::arg("plate_b_mm") = py::none(),
          py::arg("current_uA") = py::none(), py::arg("external_force_N") = py::none(),
          py::arg("name") = "run", py::arg("role") = "",
          "input: V for a stack, N for a force. displacement_mm: of the needle's plate; left out for a run "
          "that "
          "is only to be simulated. weight_g: on the plate. role: \"train\", \"test\", or \"\" for all runs.")
      .def_readonly("name", &RecordedRun::name, "That findings and signals name it by.")
      .def_readonly("period_s", &RecordedRun::period, "From row to row, s.")
      .def_property_readonly(
          "weight_g", [](const RecordedRun& r) { return r.weight * 1e3; }, "On the plate, g.")
      .def_property_readonly(
          "time_s", [](const RecordedRun& r) { return array(r.time); }, "Array [rows], s, from 0.")
      .def_property_readonly(
          "input", [](const RecordedRun& r) { return array(r.input); },
          "Array [rows], V for a stack, N for a force.")
      .def_property_readonly(
          "displacement_mm", [](const RecordedRun& r) { return array(r.displacement, 1e3); },
          "Array [rows], mm: of the needle's plate.")
      .def_property_readonly(
          "plate_b_mm", [](const RecordedRun& r) { return measured(r.plate_b, 1e3); },
          "Array [rows], mm: the other plate; None where it is not known.")
      .def_property_readonly(
          "current_uA", [](const RecordedRun& r) { return measured(r.current, 1e6); },
          "Array [rows], uA: of the amplifier; None where it is not known.")
      .def("__len__", [](const RecordedRun& r) { return r.time.size(); })
      .def("__repr__", [](const RecordedRun& r) {
        return fmt::format("<biopsy.Run \"{}\", {} rows every {:g} s>", r.name, r.time.size(), r.period);
      });

  module.def("read_model", &model_from, py::arg("file") = py::none(),
             "A model file, or the calibrated stage that rehearsals use.");
  module.def(
      "simulate",
      [](const sim::NotedModel& model, const RecordedRun& run) {
        const py::gil_scoped_release released;
        return sim::simulate(model.model, run);
      },
      py::arg("model"), py::arg("run"),
      "The run with displacement, other plate and current as the model has them; it starts at rest.");
  module.def(
      "read_dataset",
      [](const std::filesystem::path& folder, const sim::NotedModel& model) {
        return sim::read_dataset(folder, model.model.baseline.drive).runs;
      },
      py::arg("folder"), py::arg("model"), "The runs of a data set's folder, for a model of that drive.");
}

}  // namespace biopsy::python
