#include <pybind11/functional.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "planner/plan/seal.hpp"
#include "robot/common/files/temporary_folder.hpp"
#include "robot/cycle/control.hpp"
#include "robot/cycle/plan_facts.hpp"
#include "robot/procedure/procedure.hpp"
#include "robot/procedure/rehearsal.hpp"
#include "robot/procedure/rehearsed_plant.hpp"
#include "robot/python/arrays.hpp"
#include "robot/python/bindings.hpp"
#include "robot/report/procedure/labels.hpp"
#include "safety/types/hazards.hpp"
#include "sim/faults/fault_file.hpp"
#include "sim/simulated_stage.hpp"

namespace biopsy::python {
namespace {

namespace fs = std::filesystem;

robot::Case case_from(const std::string& name, std::optional<std::uint64_t> seed,
                      const std::optional<fs::path>& model) {
  robot::Case given = robot::read_case(name);
  if (seed) given.seed = *seed;
  if (model) given.rehearsal.model = *model;
  return given;
}

Plan planned(const robot::PreparedCase& prepared) {
  if (const auto* refusal = std::get_if<PlanRefusal>(&prepared.plan))
    throw ConfigError("no plan: " + refusal->what, prepared.given.title, refusal->remedy);
  return std::get<Plan>(prepared.plan);
}

py::list steps_of(const Plan& plan) {
  py::list steps;
  for (const InsertionStep& step : plan.steps) {
    py::dict of;
    of["kind"] = std::string(report::label(step.kind));
    of["depth_mm"] = step.depth.value, of["speed_mm_per_s"] = step.speed.value;
    of["v_max_V"] = step.v_max.value, of["dwell_s"] = step.dwell.count();
    of["image_confirms"] = step.image_confirms, of["why"] = step.why;
    steps.append(of);
  }
  return steps;
}

py::dict make_plan(const std::string& name, const std::optional<fs::path>& model) {
  const TemporaryFolder folder;
  const Plan plan = planned(robot::prepare(case_from(name, {}, model), folder.path()));
  py::dict of;
  of["target_depth_mm"] = plan.target_depth.value, of["axis_offset_mm"] = plan.axis_offset.value;
  of["depth_max_mm"] = plan.limits.depth_max.value, of["v_max_V"] = plan.limits.v_max.value;
  of["steps"] = steps_of(plan);
  py::list layers;
  for (const Layer& layer : plan.layers)
    layers.append(py::make_tuple(layer.name, layer.from.value, layer.to.value));
  of["layers"] = layers;
  return of;
}

report::RunRecord rehearse(const std::string& name, std::optional<double> seed,
                           const std::optional<fs::path>& model, const std::optional<std::string>& faults) {
  const TemporaryFolder folder;
  const py::gil_scoped_release released;
  const robot::PreparedCase prepared = robot::prepare(case_from(name, seed_of(seed), model), folder.path());
  planned(prepared);
  std::stop_source stop;
  std::exception_ptr raised;
  const auto look_for_interrupt = [&](double, const std::string&) {
    const py::gil_scoped_acquire held;
    if (!raised && PyErr_CheckSignals() != 0)
      raised = std::make_exception_ptr(py::error_already_set()), stop.request_stop();
  };
  const auto put_in = faults ? sim::parse_faults(*faults, "faults") : std::vector<sim::Fault>{};
  report::RunRecord record =
      robot::rehearse(prepared, folder.path(), look_for_interrupt, stop.get_token(), put_in);
  if (raised) std::rethrow_exception(raised);
  return record;
}

template <class Value>
Array column(const report::RunRecord& record, Value report::Sample::*field) {
  Array values(static_cast<py::ssize_t>(record.samples.size()));
  std::transform(record.samples.begin(), record.samples.end(), values.mutable_data(),
                 [field](const report::Sample& sample) { return static_cast<double>(sample.*field); });
  return values;
}

// Lockstep, a tick at a time: a laboratory's own controller under the product's supervisor and gate.
class Robot {
 public:
  Robot(const std::string& name, double seed, const std::optional<fs::path>& model)
      : Robot(robot::prepare(case_from(name, seed_of(seed), model), TemporaryFolder().path())) {}

  py::dict tick(bool held, bool arm, bool reset, const std::string& stop, std::optional<double> voltage_V,
                bool finish, bool depth_accepted) {
    robot::OperatorInputs inputs = robot::OperatorInputs::idle();
    if (held && !held_) ++token_;
    held_ = held;
    inputs.press = {token_, held};
    inputs.arm = arm, inputs.reset = reset, inputs.finish = finish;
    inputs.stop = stop_named(stop);
    inputs.depth_accepted = depth_accepted;
    inputs.accepted_step = step_;
    inputs.accepted_session = permit_.session, inputs.accepted_since_seq = permit_.seq;
    std::optional<std::int32_t> wanted_mV;
    if (voltage_V)
      wanted_mV =
          static_cast<std::int32_t>(std::lround(in_range(*voltage_V, -1e6, 1e6, "voltage_V", "V") * 1e3));
    const robot::CycleRecord record = cycle_.run(
        inputs, robot::Environment::healthy(),
        [&](const Measurement& measurement, const safety::SupervisorOutput& decided) {
          DriveRequest request = robot::control(
              {.measurement = measurement, .permit = decided.permit, .step = decided.step, .finish = finish},
              controller_);
          if (wanted_mV) request.wanted_mV = *wanted_mV;
          return request;
        });
    step_ = record.supervisor.step;
    permit_ = record.supervisor.permit;
    py::dict seen;
    seen["time_s"] = static_cast<double>(cycle_.ticks()) * 1e-3;
    seen["mode"] = std::string(report::label(permit_.mode));
    seen["hazard"] = record.supervisor.worst == safety::Hazard::None
                         ? py::object(py::none())
                         : py::object(py::str(std::string(safety::name_of(record.supervisor.worst))));
    seen["depth_mm"] = record.measurement.depth_um * 1e-3;
    seen["tip_mm"] = stage_.truth().motion.x * 1e3;
    seen["setpoint_mm"] = record.request.setpoint_um * 1e-3;
    seen["drive_V"] = record.drive_mV * 1e-3;
    seen["v_max_V"] = permit_.v_max_mV * 1e-3;
    seen["current_uA"] = record.measurement.current_nA * 1e-3;
    seen["step"] = record.supervisor.step;
    seen["step_done"] = record.supervisor.step_done;
    return seen;
  }

  const Plan& plan() const { return plan_; }

 private:
  explicit Robot(const robot::PreparedCase& prepared)
      : plan_(planned(prepared)),
        stage_(robot::rehearsed_plant(prepared.given.rehearsal.model, prepared.given.rehearsal.tissues,
                                      prepared.layers, prepared.given.weight.value),
               prepared.given.seed),
        cycle_(plan_, robot::plan_facts(plan_, 1 + prepared.given.seed), stage_,
               {planner::plan_tag(plan_), planner::plan_tag(plan_)}) {
    robot::load_plan(plan_, controller_);
  }

  static StopCategory stop_named(const std::string& name) {
    if (name == "none") return StopCategory::None;
    if (name == "hold") return StopCategory::C2Hold;
    if (name == "ramp") return StopCategory::C1Ramp;
    if (name == "off") return StopCategory::C0Off;
    throw ConfigError(fmt::format("\"{}\" is no stop", name), "stop", "give none, hold, ramp or off");
  }

  Plan plan_;
  sim::SimulatedStage stage_;
  robot::ControlCycle cycle_;
  robot::ControllerMemory controller_;
  Permit permit_{};
  std::uint32_t token_ = 0, step_ = 0;
  bool held_ = false;
};

}  // namespace

void bind_robot(py::module_& module) {
  module.def("plan", &make_plan, py::arg("case"), py::kw_only(), py::arg("model") = py::none(),
             "The staged plan of a built-in case (\"liver\", \"gap\") or of a case file, as a dict: "
             "target_depth_mm, "
             "axis_offset_mm, depth_max_mm, v_max_V, steps and layers (name, from mm, to mm).");

  py::class_<report::RunRecord>(module, "Rehearsal", "What happened in a rehearsal.")
      .def_property_readonly(
          "outcome", [](const report::RunRecord& r) { return std::string(report::label(r.outcome)); },
          "\"completed\", \"stopped\" or \"refused\".")
      .def_readonly("reason", &report::RunRecord::refusal, "Why it stopped; empty where it completed.")
      .def_property_readonly(
          "final_depth_mm", [](const report::RunRecord& r) { return known(r.final_depth_mm); },
          "Last depth by laser, mm; None: not measured.")
      .def_property_readonly(
          "true_depth_max_mm", [](const report::RunRecord& r) { return known(r.true_depth_max_mm); },
          "Deepest true place of the tip, mm.")
      .def_property_readonly(
          "rmse_settled_mm", [](const report::RunRecord& r) { return known(r.rmse_settled_mm); },
          "Of the depth against the target of its step while it is settled, mm; None: it never was.")
      .def_property_readonly(
          "trips",
          [](const report::RunRecord& r) {
            py::list trips;
            for (const report::Trip& trip : r.trips) trips.append(py::make_tuple(trip.time_s, trip.reason));
            return trips;
          },
          "List of (time s, reason).")
      .def_property_readonly(
          "faults",
          [](const report::RunRecord& r) {
            py::list faults;
            for (const report::FaultResult& fault : r.faults) {
              py::dict of;
              of["signal"] = fault.signal, of["kind"] = fault.kind, of["began_s"] = known(fault.began_s);
              of["detected_by"] =
                  fault.detected_by.empty() ? py::object(py::none()) : py::object(py::str(fault.detected_by));
              of["detected_after_ms"] = known(fault.detected_after_ms);
              faults.append(of);
            }
            return faults;
          },
          "The faults that were put in, with what noticed each.")
      .def_property_readonly(
          "time_s",
          [](const report::RunRecord& r) {
            Array time = column(r, &report::Sample::time_ms);
            for (py::ssize_t i = 0; i < time.size(); ++i) time.mutable_data()[i] *= 1e-3;
            return time;
          },
          "Array [ticks], s; so long are all arrays below.")
      .def_property_readonly(
          "setpoint_mm", [](const report::RunRecord& r) { return column(r, &report::Sample::setpoint_mm); },
          "Array [ticks], mm: the depth that was wanted.")
      .def_property_readonly(
          "depth_mm", [](const report::RunRecord& r) { return column(r, &report::Sample::depth_mm); },
          "Array [ticks], mm: by laser.")
      .def_property_readonly(
          "tip_mm", [](const report::RunRecord& r) { return column(r, &report::Sample::tip_mm); },
          "Array [ticks], mm: true.")
      .def_property_readonly(
          "drive_kV", [](const report::RunRecord& r) { return column(r, &report::Sample::drive_kV); },
          "Array [ticks], kV: as put out.")
      .def_property_readonly(
          "current_uA", [](const report::RunRecord& r) { return column(r, &report::Sample::current_uA); },
          "Array [ticks], uA.")
      .def_property_readonly(
          "mode",
          [](const report::RunRecord& r) {
            py::list modes;
            for (const report::Sample& sample : r.samples)
              modes.append(std::string(report::label(sample.mode)));
            return modes;
          },
          "Of the supervisor, in each tick.")
      .def("__repr__", [](const report::RunRecord& r) {
        return fmt::format("<biopsy.Rehearsal \"{}\": {}>", r.title, report::label(r.outcome));
      });

  module.def(
      "rehearse", &rehearse, py::arg("case") = "liver", py::kw_only(), py::arg("seed") = py::none(),
      py::arg("model") = py::none(), py::arg("faults") = py::none(),
      "A whole procedure on the simulated stage, tissue and scanner. model: a model file. faults: text of a "
      "file of faults.");

  py::class_<Robot>(
      module, "Robot",
      "The control cycle with its supervisor and gate on a simulated stage, one tick of 1 ms at a time.")
      .def(py::init<const std::string&, double, const std::optional<fs::path>&>(), py::arg("case") = "liver",
           py::kw_only(), py::arg("seed") = 1, py::arg("model") = py::none())
      .def(
          "tick", &Robot::tick, py::kw_only(), py::arg("held") = false, py::arg("arm") = false,
          py::arg("reset") = false, py::arg("stop") = "none", py::arg("voltage_V") = py::none(),
          py::arg("finish") = false, py::arg("depth_accepted") = false,
          "The next tick. held: the motion button; arm, reset: keys on the device; stop: \"none\", \"hold\", "
          "\"ramp\" or \"off\"; voltage_V: what a controller of yours asks for in place of the PI loop: gate "
          "and "
          "supervisor decide what reaches the stack; depth_accepted: the image of the present step confirms "
          "it. "
          "Returns time_s, mode, hazard, depth_mm (laser), tip_mm (true), setpoint_mm, drive_V (as put out), "
          "v_max_V (permitted), current_uA, step and step_done.")
      .def_property_readonly(
          "steps", [](const Robot& robot) { return steps_of(robot.plan()); },
          "Of the plan, as plan() has them.");
}

}  // namespace biopsy::python
