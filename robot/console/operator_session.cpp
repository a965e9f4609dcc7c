#include "robot/console/operator_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "planner/plan/seal.hpp"
#include "robot/common/text/encoding.hpp"
#include "robot/console/console_events.hpp"
#include "robot/console/console_labels.hpp"
#include "robot/console/operator_run.hpp"
#include "robot/live/realtime/become_realtime.hpp"
#include "robot/procedure/operator.hpp"
#include "robot/procedure/procedure.hpp"
#include "robot/procedure/run_metrics.hpp"
#include "safety/types/limits.hpp"
#include "safety/types/transitions.hpp"

namespace biopsy::robot {

namespace events = console::events;

namespace {

constexpr std::int64_t kTicksLive_us = 60'000'000;  // checks expire after a minute
// Patient and Risks, from one target to the next: to plan it and to insert takes a few minutes each; later a
// patient or who stands at the table may have changed.
constexpr std::int64_t kCarried_us = 900'000'000;
constexpr std::int64_t kArmHold_us = 2'000'000;
constexpr std::int64_t kHoldUncertain_us = 500'000;  // seen here later than it began
constexpr std::int64_t kReturn_us = 1'500'000;       // time for gravity to withdraw the needle
constexpr std::int64_t kJudgement_us = 120'000'000;  // for an image that is judged after the needle is back
constexpr std::size_t kTissuesMax = 256;

std::int64_t hold_limit_us(const CycleRecord& seen) {
  const std::int32_t most_ms = seen.measurement.brake_on ? limits::kLockedMax_ms : limits::kHoldMax_ms;
  return std::int64_t{most_ms} * 1'000;
}

double seconds_left(std::int64_t since_us, std::int64_t lasts_us, std::int64_t now_us) {
  return static_cast<double>(std::max<std::int64_t>(since_us + lasts_us - now_us, 0)) * 1e-6;
}

}  // namespace

OperatorSession::OperatorSession(PreparedCase opened, bool simulated, std::filesystem::path folder,
                                 std::uint32_t first_token, SendPlan send_plan)
    : simulated_(simulated),
      folder_(std::move(folder)),
      send_plan_(std::move(send_plan)),
      hold_(first_token),
      prepared_(std::move(opened)),
      series_(prepared_),
      proposed_(prepared_.target) {
  prepared_.image.identity.series_uid = series_.all().front().series_uid;
}

// A running check shares ownership of its run: wait for it, so that both end.
OperatorSession::~OperatorSession() {
  if (run_) run_->images.cancel();
  wait_for_results();
}

void OperatorSession::wait_for_results() const {
  if (run_ && run_->check.valid()) run_->check.wait();
  if (reporting_.valid()) reporting_.wait();
}

void OperatorSession::disconnect(console::Client client) {
  if (!lease_.release(client)) return;
  hold_.cancel();
  undisturbed_ = false;
}

const Plan* OperatorSession::plan() const {
  return p_SE_ && p_ST_ ? std::get_if<Plan>(&prepared_.plan) : nullptr;
}

bool OperatorSession::hv_permitted() const {
  return safety::hv_permitted(seen_.supervisor.permit.mode);
}

bool OperatorSession::is_displayed(const std::string& seal) const {
  return plan() != nullptr && hex(plan()->seal) == seal;
}

// The first confirmation is that of the plan, the second that of the three checks. Without both the
// supervisor neither becomes ready nor accepts a reset. So in Trip both are given but none is withdrawn, and
// during motion nothing is sent.
void OperatorSession::send_confirmations() {
  const bool complete = plan() != nullptr && confirmed_ && all_ticked();
  if (!confirmations_due_ || hv_permitted()) return;
  if (seen_.supervisor.permit.mode == Mode::Trip && !complete) return;
  confirmations_due_ = false;
  if (plan() == nullptr) return;
  const std::uint64_t tag = planner::plan_tag(*plan());
  if (complete || announced_) send_plan_(*plan(), {confirmed_ ? tag : 0, complete ? tag : 0});
  announced_ = complete;
}

// Place is not carried: it is of the plan. Patient and Risks hold once the run that they were ticked for
// ended with its depth accepted, and nothing disturbed it.
bool OperatorSession::carries_checks() const {
  return undisturbed_ && run_ && run_->ended && run_->completed && now_us_ - ticked_us_ < kCarried_us;
}

void OperatorSession::unconfirm() {
  ticks_ = {};
  confirmed_ = false;
  confirmations_due_ = true;
  ++version_;
}

OperatorInputs OperatorSession::inputs(std::int64_t now_us) {
  now_us_ = now_us;
  if (button_ == console::Button::Arm && hold_.held_for_us(now_us) >= kArmHold_us) {
    hold_.cancel();
    arm_until_us_ = now_us + kKeyTurned_us;
  }
  OperatorInputs inputs = OperatorInputs::idle();
  inputs.arm = simulated_ && now_us < arm_until_us_;
  inputs.reset = simulated_ && now_us < reset_until_us_;
  const auto held = hold_.held(now_us);
  const bool inserting = held && button_ == console::Button::Insert;
  if (inserting) last_token_ = *held;
  inputs.press = {last_token_, inserting};
  if (now_us < retract_until_us_) inputs.stop = StopCategory::C1Ramp;
  if (now_us < stop_until_us_ || standing_stop_) inputs.stop = StopCategory::C0Off;
  if (navigation_) inputs.stop = std::max(inputs.stop, navigation_->stop);
  inputs.finish = finish_;
  inputs.patient_motion_um = patient_motion_um_;
  if (run_) {
    inputs.acquiring = run_->acquiring_us.has_value();
    inputs.hold_still = run_->locking || inputs.acquiring;
    inputs.depth_accepted = run_->accepted.has_value();
    inputs.accepted_step = static_cast<std::uint32_t>(run_->accepted.value_or(0));
    inputs.accepted_session = run_->imaged_under.session;
    inputs.accepted_since_seq = run_->imaged_under.seq;
  }
  inputs_ = inputs;
  return inputs;
}

void OperatorSession::update(const CycleSample& sample, std::int64_t now_us) {
  const Mode before = seen_.supervisor.permit.mode;
  held_too_long_ =
      before == Mode::Hold && now_us - mode_since_us_ >= hold_limit_us(seen_) - kHoldUncertain_us;
  seen_ = sample.record;
  shown_depth_.add(seen_.measurement);
  measured_ = true;
  silent_ = false;
  now_us_ = now_us;
  const Mode mode = seen_.supervisor.permit.mode;
  if (mode != before) mode_since_us_ = now_us;
  if (mode == Mode::Trip || mode == Mode::Lock) undisturbed_ = false;
  // A stop or a retraction is repeated until high voltage is off.
  if (hv_permitted() && stop_until_us_ > now_us) stop_until_us_ = now_us + kStopLasts_us;
  if (hv_permitted() && retract_until_us_ > now_us) retract_until_us_ = now_us + kStopLasts_us;
  if (!hv_permitted()) finish_ = false;
  const bool startable = mode == Mode::Ready || mode == Mode::Armed;
  if (startable && !standing_stop_ && now_us >= stop_until_us_) stopped_ = false;
  const bool waiting = all_ticked() && !hv_permitted();
  if (waiting && now_us - ticked_us_ > kTicksLive_us) {
    ticks_ = {};
    confirmations_due_ = true;
  }
  update_run(sample, before);
  send_confirmations();
  if (!hv_permitted()) series_.look(now_us), show_series();
}

// Points and plan belong to the previous series.
void OperatorSession::show_series() {
  std::optional<Volume> image = series_.take();
  if (!image) return;
  undisturbed_ = false;
  patient_motion_um_ = 0;  // since this image
  prepared_.image = std::move(*image);
  prepared_.target.patient_id = prepared_.image.identity.patient_id;
  prepared_.target.series_uid = prepared_.image.identity.series_uid;
  p_SE_.reset();
  p_ST_.reset();
  opened_ = true;
  ++version_;
  for (const console::commands::SetPoint& point : std::exchange(restored_, {})) on(point);
}

void OperatorSession::update_run(const CycleSample& sample, Mode before) {
  const Mode mode = seen_.supervisor.permit.mode;
  if (mode == Mode::Armed && before != Mode::Armed && plan() != nullptr) {
    run_ = std::make_shared<Run>(prepared_, folder_ / fmt::format("run-{}", ++runs_));
    report_.clear();
    undisturbed_ = !silent_;
    ++version_;
  }
  if (!run_ || run_->ended) return;
  run_->notes.add(sample, inputs_);
  run_->moved = run_->moved || mode == Mode::Active;
  note_end_of_hold(before);
  if (mode == Mode::Active) run_->patient_moved = false;
  run_->patient_moved = run_->patient_moved || is_patient_moving();
  update_image();
  if (hv_permitted()) {
    run_->cold_since_us = now_us_;
  } else if (!run_->moved) {
    run_.reset();  // armed without motion
  } else if (now_us_ - run_->cold_since_us > (run_->is_undecided() ? kJudgement_us : kReturn_us) &&
             !run_->check.valid()) {
    end_run();
  }
}

// What ended the hold in which an image was taken; a trip undoes what was accepted before.
void OperatorSession::note_end_of_hold(Mode before) {
  const safety::SupervisorOutput& now = seen_.supervisor;
  const Mode mode = now.permit.mode;
  if (mode == Mode::Active) run_->left_hold.reset();
  const bool tripped = mode != before && (mode == Mode::Trip || mode == Mode::Lock);
  const bool left = before == Mode::Hold && mode != Mode::Hold && mode != Mode::Active && run_->imaged;
  if (!tripped && !left) return;
  // An event is of one tick, which the bus need not bring.
  const bool unsaid = now.reason == safety::Hazard::None && now.event == safety::Event::None;
  const std::string why = unsaid && held_too_long_ ? std::string(safety::name_of(safety::Event::HoldTooLong))
                                                   : cause_of(now, seen_.panel_unread_ms);
  if (left) run_->left_hold = why;
  if (run_->completed && !tripped) return;  // its depth was accepted in time
  run_->completed = false;
  if (run_->stopped_because.empty() && (tripped || run_->imaged))
    run_->ended_by = fmt::format("{}: {}", safety::name_of(mode), why);
}

// By the supervisor, and by what it is told: beside a worse hazard it does not name this one.
bool OperatorSession::is_patient_moving() const {
  const auto beyond = [](std::int32_t motion_um) {
    return motion_um < 0 || motion_um > safety::kPatientMotion_um;
  };
  return names_patient_motion(seen_.supervisor) || beyond(patient_motion_um_) ||
         (navigation_ && navigation_->measures_patient && beyond(navigation_->patient_motion_um));
}

// The report takes a second: written in another thread.
void OperatorSession::end_run() {
  run_->ended = true;
  ticks_ = {};
  confirmations_due_ = true;
  if (std::exchange(adjusts_, false)) confirmed_ = false;  // back to the points
  ++version_;
  report::RunRecord& record = run_->notes.record();
  record.simulated = simulated_;
  record.real_time = true;
  record.outcome = run_->completed ? report::Outcome::Completed : report::Outcome::Stopped;
  const bool accepted = run_->accepted && run_->is_last(*run_->accepted);
  // What the robot did first, then what a person said of it.
  std::string why;
  if (!run_->ended_by.empty())
    why = fmt::format("{}; the depth was {}accepted before", run_->ended_by, accepted ? "" : "not ");
  if (!run_->stopped_because.empty()) why += (why.empty() ? "" : "; ") + run_->stopped_because;
  if (!run_->completed)
    record.refusal = why.empty() ? "the needle retracted before its depth was accepted" : why;
  reporting_ = std::async(std::launch::async, [run = run_] {
    realtime::run_in_background();
    measure_run(run->notes.record());
    fmt::print("{}", finish(run->notes.record(), run->prepared, run->folder, run->started));
  });
}

std::optional<events::Opened> OperatorSession::opened() const {
  if (!opened_) return std::nullopt;
  events::Opened opened;
  opened.series = series_of(prepared_.image);
  if (has_points(prepared_.given))
    opened.proposal.push_back({ras_of(proposed_.p_SE), ras_of(proposed_.p_ST)});
  opened.volume = series_.file_name();
  if (series_.labels()) opened.labels = ConsoleSeries::kLabelsName;
  for (const auto& [value, name] : prepared_.label_names)
    if (value >= 0 && opened.tissues.size() < kTissuesMax)
      opened.tissues.push_back({static_cast<std::uint32_t>(value), name});
  opened.reach = (limits::kStroke_um - limits::kDepthMargin_um) * 1e-3;
  return opened;
}

events::Planned OperatorSession::planned() const {
  return planned_of(prepared_, p_SE_, p_ST_, confirmed_);
}

std::vector<events::Checked> OperatorSession::checked() const {
  std::vector<events::Checked> all;
  if (!run_) return all;
  const auto& steps = run_->notes.record().steps;
  for (std::size_t step = 0; step < steps.size(); ++step)
    if (steps[step].check) all.push_back(checked_of(step, steps[step]));
  return all;
}

events::State OperatorSession::state(console::Client client, std::int64_t now_us) {
  using std::chrono::seconds;
  if (reporting_.valid() && reporting_.wait_for(seconds(0)) == std::future_status::ready) {
    reporting_.get();
    report_ = run_->folder / "report.html";
  }
  const safety::SupervisorOutput& supervisor = seen_.supervisor;
  events::State state;
  state.seq = ++seq_;
  state.mode = supervisor.permit.mode;
  state.step = step();
  state.controller = lease_.is_held_by(client);
  state.controlled = lease_.is_held();
  state.token = state.controller ? hold_.next_token() : 0;
  state.depth = shown_depth_.mean_um() * 1e-3;
  state.drive = seen_.measurement.monitor_mV * 1e-6;
  state.measured = measured_ && !silent_;
  state.depth_known = shown_depth_.is_known();
  state.estop = measured_ && (seen_.evidence.clear & safety::bit(safety::Hazard::EStop)) == 0;
  if (run_ && run_->check.valid()) state.scanner = console::Scanner::Checking;
  if (run_ && run_->acquiring_us) state.scanner = console::Scanner::Acquiring;
  state.stage = supervisor.step;
  state.stage_done = supervisor.step_done;
  state.locked = measured_ && seen_.measurement.brake_on;
  const Case& given = prepared().given;
  const Seconds scan = scan_time(seen_.measurement.brake_fitted, given.rehearsal.scan);
  if (given.images.folder.empty() && scan < kRealScan) state.short_scan = scan.count();
  state.ticks = ticks_;
  const Mode mode = supervisor.permit.mode;
  if (mode == Mode::Hold) state.hold_left = seconds_left(mode_since_us_, hold_limit_us(seen_), now_us);
  if (mode == Mode::Armed)
    state.armed_left = seconds_left(mode_since_us_, std::int64_t{limits::kArmedMax_ms} * 1'000, now_us);
  if (all_ticked() && !hv_permitted()) state.ticks_left = seconds_left(ticked_us_, kTicksLive_us, now_us);
  if (carries_checks()) state.carried_left = seconds_left(ticked_us_, kCarried_us, now_us);
  if (hold_.held(now_us)) state.held.push_back(button_);
  if (button_ == console::Button::Arm) state.arm_held = static_cast<double>(hold_.held_for_us(now_us)) * 1e-6;
  state.completed = run_ && run_->completed;
  state.reading = series_.reading();
  state.report = report_.empty() ? "" : "/report.html";
  state.disabled = disabled();
  state.alarms = alarms();
  return state;
}

std::vector<events::Alarm> OperatorSession::alarms() const {
  std::vector<events::Alarm> alarms = alarms_of(seen_, shown_depth_.mean_um(), stopped_);
  for (events::Alarm& notice : navigation_alarms()) alarms.push_back(std::move(notice));
  if (standing_stop_) alarms.insert(alarms.begin(), standing_stop_alarm());
  if (silent_) alarms.insert(alarms.begin(), silence_alarm());
  return alarms;
}

}  // namespace biopsy::robot
