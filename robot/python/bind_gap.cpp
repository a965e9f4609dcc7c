#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include "robot/python/arrays.hpp"
#include "robot/python/bindings.hpp"
#include "robot/report/gap/gap_labels.hpp"
#include "robot/report/gap/gap_report.hpp"
#include "sim/gap/find_gap.hpp"
#include "sim/gap/select/evidence_runs.hpp"
#include "sim/plant/model_file.hpp"

namespace biopsy::python {
namespace {

struct Finding {
  GapFinding found;
  sim::NotedModel model;
};

using Report = std::function<void(double, const std::string&)>;

Finding find(const sim::NotedModel& model, const std::vector<sim::RecordedRun>& runs,
             const std::vector<std::string>& free, std::optional<double> window_s,
             std::optional<double> sensor_noise_mm, std::optional<bool> tissue, const Report& progress) {
  sim::Dataset dataset{.title = "runs from Python", .sensor_noise = {}, .tissue = tissue, .runs = runs};
  if (sensor_noise_mm)
    dataset.sensor_noise = in_range(*sensor_noise_mm, 0.0, 100.0, "sensor_noise_mm", "mm") * 1e-3;
  if (runs.empty()) throw ConfigError("there is no run", "runs", "give one at least");
  if (window_s) sim::gap::check_window(dataset, in_range(*window_s, 1e-3, 1e6, "window_s", "s"));
  std::stop_source stop;
  std::exception_ptr raised;  // by `progress`, or Ctrl-C: the search ends, then it goes on to the caller
  const auto tell = [&](double share, const std::string& doing) {
    const py::gil_scoped_acquire held;
    if (raised) return;
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      if (progress) progress(share, doing);
    } catch (...) {
      raised = std::current_exception();
      stop.request_stop();
    }
  };
  std::optional<sim::gap::FoundGap> found;
  {
    const py::gil_scoped_release released;
    found = sim::gap::find_gap(dataset, model.model,
                               {.free = free, .window = window_s, .stop = stop.get_token()}, tell);
  }
  if (raised) std::rethrow_exception(raised);
  sim::ModelNotes notes = model.notes;
  for (const auto& [name, std] : found->changed) {
    notes.values[name].std = std::isfinite(std) ? std::optional(std) : std::nullopt;
    notes.values[name].source = dataset.title;
  }
  return {found->finding, {found->model, notes}};
}

}  // namespace

void bind_gap(py::module_& module) {
  py::class_<Finding>(module, "Finding", "Where model and measurement disagree, and what is missing.")
      .def_property_readonly(
          "verdict", [](const Finding& f) { return std::string(report::label(f.found.verdict)); },
          "\"no_gap\", \"parameter\", \"effect\" or \"unexplained\".")
      .def_property_readonly(
          "sentence", [](const Finding& f) { return report::verdict_sentence(f.found); },
          "The finding in words, as the report has it.")
      .def_property_readonly(
          "effects",
          [](const Finding& f) {
            std::vector<std::string> names;
            for (const FoundEffect& effect : f.found.effects) names.push_back(effect.name);
            return names;
          },
          "Names of the missing effects, the strongest first.")
      .def_property_readonly(
          "gap_closed", [](const Finding& f) { return known(f.found.gap_closed); },
          "Share of the excess error of runs that were not fitted, 0 to 1.")
      .def_property_readonly(
          "rmse_before_mm", [](const Finding& f) { return known(f.found.rmse_before); },
          "RMS of simulated minus measured with the model given, mm; None: not known.")
      .def_property_readonly(
          "rmse_after_mm", [](const Finding& f) { return known(f.found.rmse_after); },
          "The same with the better model, mm.")
      .def_property_readonly(
          "noise_mm", [](const Finding& f) { return known(f.found.noise_floor); }, "Of the sensor, mm RMS.")
      .def_property_readonly(
          "changed",
          [](const Finding& f) {
            py::dict changed;
            for (const ChangedParameter& p : f.found.parameters_changed)
              changed[py::str(p.name)] = py::make_tuple(p.before, p.after, p.std);
            for (const FoundEffect& effect : f.found.effects)
              for (const GapEstimate& p : effect.parameters)
                changed[py::str(effect.name + "." + p.name)] = py::make_tuple(py::none(), p.value, p.std);
            return changed;
          },
          "name -> (before, after, standard deviation), in the unit of model files; before: None for a new "
          "effect.")
      .def_property_readonly(
          "data_remarks",
          [](const Finding& f) {
            std::vector<std::string> remarks;
            for (const DataRemark& remark : f.found.data) remarks.push_back(remark.sentence);
            return remarks;
          },
          "What is wrong, or should be known, about the records themselves.")
      .def_property_readonly(
          "signals",
          [](const Finding& f) {
            py::dict runs;
            for (const GapSignals& s : f.found.signals) {
              py::dict of;
              of["time_s"] = array(s.time), of["input"] = array(s.input),
              of["measured_mm"] = array(s.measured);
              of["before_mm"] = array(s.before), of["after_mm"] = array(s.after);
              runs[py::str(s.run)] = of;
            }
            return runs;
          },
          "By run: arrays time_s, input, measured_mm, before_mm and after_mm.")
      .def_readonly("model", &Finding::model,
                    "The better model; where nothing was found, that which was given.")
      .def("__repr__", [](const Finding& f) {
        return fmt::format("<biopsy.Finding: {}>", report::verdict_sentence(f.found));
      });

  module.def(
      "gap", &find, py::arg("model"), py::arg("runs"), py::kw_only(),
      py::arg("free") = std::vector<std::string>{}, py::arg("window_s") = py::none(),
      py::arg("sensor_noise_mm") = py::none(), py::arg("tissue") = py::none(),
      py::arg("progress") = py::none(),
      "Compares a model with runs and names what it is missing. free: parameters fitted without a prior; "
      "window_s: runs are cut into windows of this length; both are chosen from the data where neither is "
      "given. tissue: whether the needle meets tissue. progress(share, doing): called now and then; what it "
      "raises ends the search.");
}

}  // namespace biopsy::python
