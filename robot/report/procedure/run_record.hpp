// Everything that is known of one run, as values: what the report, the JSON and the CSV are made from.
// An unknown number stays kUnknown: it is printed as a dash and written as null.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robot/common/picture.hpp"
#include "robot/msg/depth_check.hpp"
#include "robot/msg/fixed_messages.hpp"
#include "robot/msg/plan.hpp"
#include "robot/msg/volume.hpp"

namespace biopsy::report {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

enum class Outcome : std::uint8_t { Completed, Refused, Stopped };

// One control tick: what was measured at time_ms, and the drive that was then put out until the next tick.
struct Sample {
  double time_ms = 0;     // on the stage's clock, from the first one
  float setpoint_mm = 0;  // rate-limited target depth
  float depth_mm = 0;     // laser
  float tip_mm = 0;       // true needle tip, known in simulation only
  float plate_b_mm = 0;   // simulation only
  float drive_kV = 0;     // signed, what the gate put out
  float envelope_kV = 0;  // the permit's limit of |V|
  float monitor_kV = 0;
  float current_uA = 0;
  Mode mode = Mode::Boot;
  StopCategory stop = StopCategory::None;
  std::uint8_t step = 0;
  bool locked = false;   // by the brake
  bool measured = true;  // depth_mm: both lasers had their targets and agreed
  GateVerdict verdict = GateVerdict::Refused;
};

// Where the needle lies in a picture. Pixels count from the top left corner; the centre of the first is (0.5,
// 0.5).
struct SliceGeometry {
  double entry_x_px = 0, entry_y_px = 0;  // the tip at displacement zero
  double axis_dx = 0, axis_dy = 1;        // insertion direction in the picture, unit length
  double mm_per_pixel = 0;
  // Where the picture's sides lie in the patient, e.g. "AR" for anterior and right; empty: not drawn.
  std::string left = {}, right = {}, top = {}, bottom = {};
};

// A plane of the body through the target; pixels count from the centre of the first one.
struct BodyPlane {
  std::string name;           // "Axial"
  std::string place, window;  // "S 51.9 mm, slice 12 of 40"; "black 0, white 812"
  Picture picture;
  std::array<double, 2> entry_px{}, target_px{};
  std::string left, right, top, bottom;  // the patient's sides
};

// What became of one planned step.
struct StepResult {
  InsertionStep step;
  bool reached = false;
  double reached_s = kUnknown;        // when, from the start of the run
  double depth_mm = kUnknown;         // laser, mean of the settled window
  double rmse_settled_mm = kUnknown;  // depth against the step's target over its settled window
  double overshoot_mm = kUnknown;
  std::string layer_at_tip;
  std::optional<DepthCheck> check;
  double image_s = kUnknown;  // when the confirmation image was taken, from the start of the run
  bool hv_switching_during_image = false;
  double image_motion_mm = kUnknown;  // between the needle's extremes while it was taken; simulation only
  std::string image_path;             // relative to the report's folder
  Picture before, after;  // registered slices through the needle, same pixels; empty where there is no image
  std::optional<SliceGeometry>
      geometry;  // of both; the report then draws the detected tip, otherwise `after` shows it
};

// A limit and how much of it was used, both in `unit`.
struct LimitUse {
  std::string name;
  double used = 0, limit = 0;
  std::string unit;
};

struct Trip {
  double time_s = 0;
  StopCategory stop = StopCategory::None;
  std::string reason;
};

// A fault that was put into a simulated run, and what noticed it.
struct FaultResult {
  std::string signal, kind;             // as in the file of faults
  double began_s = kUnknown;            // from the start of the run; unknown: it never began
  std::string detected_by = {};         // hazard, "depth check" or "held too long"; empty: by nothing
  double detected_after_ms = kUnknown;  // from its beginning
};

struct RunRecord {
  std::string title;
  bool simulated = true;
  bool real_time = false;  // on a clock, and not in lockstep
  Outcome outcome = Outcome::Refused;
  std::string refusal;  // empty unless refused or stopped
  std::string remedy;
  SeriesIdentity series;
  std::string image_source;                 // path as given
  std::vector<std::string> image_warnings;  // of image, points and path
  std::string
      registration;  // "registered", "given" or "assumed": how the robot's place in the scanner is known
  std::optional<Plan> plan;
  Picture planning_slice;  // slice through the needle
  std::optional<SliceGeometry>
      planning_geometry;          // the report then draws layers, entry, target and path over it
  std::vector<BodyPlane> planes;  // axial, coronal, sagittal
  std::vector<Sample> samples;    // one per tick
  std::vector<StepResult> steps;
  std::vector<LimitUse> limits;
  std::vector<Trip> trips;
  double final_depth_mm = kUnknown;  // laser, at the end of the last step
  double left_depth_mm = kUnknown;   // laser, at the end of the run at 0 V: what friction left
  bool left_unmeasured = false;      // at 0 V, but the lasers did not tell where
  double true_depth_max_mm = kUnknown,
         true_final_depth_mm = kUnknown;  // tip: deepest, at the end; simulation only
  std::vector<FaultResult> faults;
  double image_depth_mm = kUnknown, image_depth_sigma_mm = kUnknown;
  std::string layer_at_tip;  // where the needle was last driven, once a step was reached
  double rmse_settled_mm = kUnknown, rmse_all_mm = kUnknown, overshoot_mm = kUnknown, peak_kV = kUnknown;
  // How the run kept time. In lockstep all is zero.
  std::uint64_t lost_ticks = 0;      // of the stage, that were not received
  double longest_gap_ms = 0;         // on its clock, between two that were
  std::uint64_t ticks_left_out = 0;  // received, and without a sample: memory is bounded
  std::uint32_t unasked_holds = 0;   // not at a step's end, the button held
  double simulated_s = kUnknown;
  double wall_s = kUnknown;  // the only field that differs between two runs of one seed
  std::uint64_t seed = 0;
  std::vector<std::pair<std::string, std::string>> provenance;  // versions, hashes: name, value
};

}  // namespace biopsy::report
