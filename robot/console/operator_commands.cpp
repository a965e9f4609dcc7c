// Commands of the page: done, or refused with the reason.
#include <fmt/format.h>

#include <algorithm>

#include "planner/plan/seal.hpp"
#include "robot/common/config_error.hpp"
#include "robot/console/console_events.hpp"
#include "robot/console/console_labels.hpp"
#include "robot/console/operator_run.hpp"
#include "robot/console/operator_session.hpp"
#include "robot/console/server/picked_point.hpp"
#include "safety/types/hazards.hpp"
#include "safety/types/limits.hpp"

namespace biopsy::robot {

namespace commands = console::commands;
namespace events = console::events;

namespace {

events::Answer done(std::uint32_t id) {
  return {id, true, {}, {}, {}, {}};
}

}  // namespace

std::optional<events::Answer> OperatorSession::handle(console::Client client, const commands::Any& command,
                                                      std::int64_t now_us) {
  now_us_ = now_us;
  if (const auto* stop = std::get_if<commands::Stop>(&command)) return on(*stop);  // from any page
  if (const auto* take = std::get_if<commands::TakeControl>(&command)) return on(client, *take);
  const bool controls = lease_.is_held_by(client);
  if (const auto* beat = std::get_if<commands::Beat>(&command)) {
    if (controls) hold_.beat(beat->token, beat->page_ms, now_us);
    return std::nullopt;
  }
  if (const auto* release = std::get_if<commands::Release>(&command)) {
    if (controls) hold_.release(release->token);
    return std::nullopt;
  }
  return std::visit(
      [&](const auto& one) -> Answer {
        if constexpr (requires {
                        on(one);
                        one.id;
                      }) {
          return controls ? on(one) : Answer(refusal(one.id, Refused::NotController));
        } else {
          return std::nullopt;
        }
      },
      command);
}

OperatorSession::Answer OperatorSession::on(console::Client client, const commands::TakeControl& command) {
  return lease_.take(client) ? done(command.id) : refusal(command.id, Refused::NotController);
}

OperatorSession::Answer OperatorSession::on(const commands::OpenSeries& command) {
  if (hv_permitted()) return refusal(command.id, Refused::NeedleInUse);
  if (command.series_uid != prepared_.image.identity.series_uid) {
    if (run_ && !run_->ended) return refusal(command.id, Refused::NotNow, "the last run is not over");
    if (const auto why = series_.begin(command.series_uid))
      return refusal(command.id, Refused::NoSeries, *why);
    unconfirm();
    return done(command.id);
  }
  opened_ = true;
  ++version_;
  return done(command.id);
}

OperatorSession::Answer OperatorSession::on(const commands::SetPoint& command) {
  if (!opened_) return refusal(command.id, Refused::NoSeries);
  if (hv_permitted()) return refusal(command.id, Refused::NeedleInUse);
  const auto picked = console::picked_point(prepared_.image, command);
  if (const auto* why = std::get_if<std::string>(&picked))
    return refusal(command.id, Refused::WrongPlace, *why);
  unconfirm();
  restore_pose();
  (command.mark == console::Mark::Entry ? p_SE_ : p_ST_) = std::get<Point>(picked);
  if (p_SE_ && p_ST_) {
    prepared_.target.p_SE = *p_SE_;
    prepared_.target.p_ST = *p_ST_;
    try {
      plan_to_target(prepared_);
    } catch (const ConfigError& error) {  // the path leaves the label map
      prepared_.plan = PlanRefusal{error.what_is_wrong, error.remedy};
    }
  }
  return done(command.id);
}

OperatorSession::Answer OperatorSession::on(const commands::ConfirmPlan& command) {
  if (plan() == nullptr) return refusal(command.id, Refused::NoPlan);
  if (!is_displayed(command.seal)) return refusal(command.id, Refused::OldPlan);
  if (hv_permitted()) return refusal(command.id, Refused::NeedleInUse);
  confirmed_ = true;
  ++version_;
  return done(command.id);
}

OperatorSession::Answer OperatorSession::why_no_check(std::uint32_t id, const std::string& seal) const {
  if (!confirmed_) return refusal(id, Refused::NoPlan, "confirm the plan first");
  if (!is_displayed(seal)) return refusal(id, Refused::OldPlan);
  if (hv_permitted()) return refusal(id, Refused::NeedleInUse);
  return std::nullopt;
}

OperatorSession::Answer OperatorSession::on(const commands::SetTick& command) {
  if (const Answer refused = why_no_check(command.id, command.seal)) return refused;
  ticks_[static_cast<std::size_t>(command.tick)] = command.on;
  if (!command.on && command.tick != console::Tick::Place) undisturbed_ = false;
  if (all_ticked()) ticked_us_ = now_us_;
  confirmations_due_ = true;
  return done(command.id);
}

OperatorSession::Answer OperatorSession::on(const commands::RenewChecks& command) {
  if (const Answer refused = why_no_check(command.id, command.seal)) return refused;
  if (!carries_checks()) return refusal(command.id, Refused::NotNow, "tick all three checks");
  ticks_ = {true, true, true};
  ticked_us_ = now_us_;
  confirmations_due_ = true;
  return done(command.id);
}

OperatorSession::Answer OperatorSession::on(const commands::Press& command) {
  const bool arm = command.button == console::Button::Arm;
  if (arm && !simulated_) return refusal(command.id, Refused::OnlyOnDevice);
  const std::string why = arm ? why_no_arm() : why_no_insert();
  if (!why.empty()) return refusal(command.id, Refused::NotNow, why);
  if (!hold_.press(command.token, command.page_ms, now_us_)) return refusal(command.id, Refused::TokenUsed);
  button_ = command.button;
  return done(command.id);
}

// In force until high voltage is off, whatever else is commanded.
OperatorSession::Answer OperatorSession::on(const commands::Stop& command) {
  hold_.cancel();
  undisturbed_ = false;
  const Mode mode = seen_.supervisor.permit.mode;
  standing_stop_ = !hv_permitted() && mode != Mode::Trip && mode != Mode::Lock;
  stopped_ = true;
  stop_until_us_ = now_us_ + kStopLasts_us;
  if (run_ && !run_->ended && !run_->completed) run_->stopped_because = "STOP was pressed";
  return done(command.id);
}

void OperatorSession::retract() {
  hold_.cancel();
  if (run_ && run_->completed)
    finish_ = true;
  else
    retract_until_us_ = now_us_ + kStopLasts_us;
}

OperatorSession::Answer OperatorSession::on(const commands::Retract& command) {
  if (!hv_permitted()) return refusal(command.id, Refused::NotNow, disabled().retract);
  retract();
  return done(command.id);
}

OperatorSession::Answer OperatorSession::on(const commands::Reset& command) {
  if (standing_stop_) {  // its own request, which it may take back anywhere
    standing_stop_ = stopped_ = false;
    stop_until_us_ = 0;
    return done(command.id);
  }
  if (!simulated_) return refusal(command.id, Refused::OnlyOnDevice);
  if (const std::string why = why_no_reset(); !why.empty()) return refusal(command.id, Refused::NotNow, why);
  stop_until_us_ = 0;
  reset_until_us_ = now_us_ + kKeyTurned_us;
  return done(command.id);
}

OperatorSession::Answer OperatorSession::on(const commands::Judge& command) {
  const std::string why = why_no_judgement();
  if (!why.empty() || run_->imaged != command.stage) return refusal(command.id, Refused::NotNow, why);
  if (command.judgement == console::Judgement::Accept) {
    if (const std::string why_not = why_no_acceptance(); !why_not.empty())
      return refusal(command.id, Refused::NotNow, why_not);
    run_->accepted = command.stage;
    run_->completed = run_->is_last(command.stage);
    return done(command.id);
  }
  adjusts_ = command.judgement == console::Judgement::Adjust;
  run_->stopped_because = adjusts_ ? "adjusted by the operator after the image" : "rejected by the operator";
  retract();
  return done(command.id);
}

std::optional<commands::OpenSeries> OperatorSession::chosen_series() const {
  if (!opened_) return std::nullopt;
  return commands::OpenSeries{0, prepared_.image.identity.series_uid};
}

std::vector<commands::SetPoint> OperatorSession::chosen_points() const {
  std::vector<commands::SetPoint> points;
  if (own_pose_) return points;
  const auto add = [&](console::Mark mark, const std::optional<Point>& p_S) {
    if (!p_S) return;
    const Eigen::Vector3d voxel = prepared_.image.grid.X_SI.inverse() * *p_S;
    points.push_back(
        {0, mark, prepared_.image.identity.series_uid, {voxel.x(), voxel.y(), voxel.z()}, ras_of(*p_S)});
  };
  add(console::Mark::Entry, p_SE_);
  add(console::Mark::Target, p_ST_);
  return points;
}

// As a page would have sent it; what is refused is left out. The robot may still have what the earlier
// console confirmed.
void OperatorSession::restore(const std::vector<commands::Any>& chosen) {
  announced_ = !chosen.empty();
  for (const commands::Any& command : chosen) {
    if (const auto* series = std::get_if<commands::OpenSeries>(&command)) on(*series);
    if (const auto* point = std::get_if<commands::SetPoint>(&command)) {
      if (series_.reading().empty())
        on(*point);
      else
        restored_.push_back(*point);
    }
    if (std::holds_alternative<commands::Stop>(command)) standing_stop_ = stopped_ = true;
  }
}

console::Step OperatorSession::step() const {
  using console::Step;
  const Mode mode = seen_.supervisor.permit.mode;
  const bool step_end = mode == Mode::Hold && seen_.supervisor.step_done;
  if (hv_permitted()) {
    const bool waits = run_ && step_end && run_->accepted != seen_.supervisor.step;
    return waits || (run_ && run_->completed) ? Step::Confirm : Step::Insert;
  }
  if (run_ && !run_->ended && run_->moved) return Step::Confirm;
  if (!opened_) return Step::Image;
  if (!confirmed_) return Step::Plan;
  const bool shows_run = run_ && plan() != nullptr && plan()->seal == run_->plan().seal;
  if (shows_run && std::none_of(ticks_.begin(), ticks_.end(), [](bool tick) { return tick; }))
    return Step::Confirm;
  return all_ticked() ? Step::Arm : Step::Check;
}

// Of a real stage, once this console has confirmed the plan.
std::string OperatorSession::why_second_person() const {
  const bool missing = seen_.supervisor.worst == safety::Hazard::PlanUnconfirmed;
  if (simulated_ || !missing || !confirmed_ || !all_ticked()) return {};
  return fmt::format("a second person runs `biopsy confirm` and compares the seal {}.",
                     hex(plan()->seal).substr(0, 8));
}

std::string OperatorSession::why_no_arm() const {
  const Mode mode = seen_.supervisor.permit.mode;
  if (!confirmed_) return "Confirm the plan first.";
  if (hv_permitted()) return "It is armed.";
  if (run_ && !run_->ended) return "The last run is not over: judge its image.";
  if (!all_ticked()) return carries_checks() ? "Tick the check first." : "Tick all three checks first.";
  if (mode == Mode::Trip || standing_stop_) return "Stopped: Reset first.";
  if (mode == Mode::Lock) return "Locked: service only.";
  if (const std::string person = why_second_person(); !person.empty()) return "Not ready yet: " + person;
  if (mode != Mode::Ready)
    return fmt::format("Not ready yet: {}.", hazard_text(seen_.supervisor.worst, seen_.panel_unread_ms));
  return simulated_ ? "" : "Turn the arm key on the device.";
}

std::string OperatorSession::why_no_insert() const {
  const Mode mode = seen_.supervisor.permit.mode;
  if (mode == Mode::Armed || mode == Mode::Active) return {};
  if (mode != Mode::Hold) return "Arm first.";
  if (!seen_.supervisor.step_done) return {};
  if (!run_ || run_->is_last(seen_.supervisor.step))
    return "The plan is done: look at the image, then Retract.";
  return run_->accepted == seen_.supervisor.step ? "" : "Accept the image first.";
}

std::string OperatorSession::why_no_judgement() const {
  if (!run_ || !run_->imaged) return "No image was taken yet.";
  if (run_->acquiring_us && run_->images.from_scanner()) {
    const std::chrono::duration<double> most = run_->prepared.given.images.patience;
    return fmt::format("Wait for the scanner's image, {:.0f} s at most, or Retract.", most.count());
  }
  if (!run_->is_checked(*run_->imaged)) return "Wait for the image.";
  if (run_->accepted == run_->imaged) return "It is accepted.";
  return run_->ended || !run_->stopped_because.empty() ? "This run is over." : "";
}

// An image says where the needle is only while it is held there, in a patient who lies still.
std::string OperatorSession::why_no_acceptance() const {
  if (const std::string why = why_no_judgement(); !why.empty()) return why;
  const safety::SupervisorOutput& now = seen_.supervisor;
  const bool held = now.permit.mode == Mode::Hold && now.step_done && now.step == *run_->imaged;
  if (!held || silent_ || run_->left_hold)
    return fmt::format("The needle is no longer held where this image shows it{}.",
                       run_->left_hold ? ": " + *run_->left_hold : "");
  if (run_->patient_moved)
    return "The patient moved by more than 2 mm while the needle was held here: reject, take a new image and "
           "plan anew.";
  if (run_->notes.record().steps[*run_->imaged].hv_switching_during_image)
    return "The drive switched, or the needle slipped, while this image was taken: reject it; after another "
           "insertion there is another image.";
  const DepthCheck& check = *run_->notes.record().steps[*run_->imaged].check;
  if (check.verdict == DepthVerdict::Accept) return {};
  return check.verdict == DepthVerdict::Reject ? "The image shows the tip elsewhere than planned."
                                               : "The image does not tell surely enough where the tip is.";
}

// In the words of a person what the supervisor would refuse; its own refusal lasts one tick.
std::string OperatorSession::why_no_reset() const {
  const Mode mode = seen_.supervisor.permit.mode;
  if (standing_stop_) return {};
  if (mode == Mode::Lock) return "Locked: service only.";
  const bool latched = seen_.supervisor.worst == safety::Hazard::EStop;  // pressed at rest, or unreadable
  if (mode != Mode::Trip && !latched) return "Nothing to reset.";
  if (const std::string person = why_second_person(); !person.empty()) return "Before that " + person;
  if (mode == Mode::Trip && waits_for_plan(seen_.supervisor.worst))
    return "Confirm the plan and tick the three checks first.";
  if (!simulated_) return "Turn the reset key on the device.";
  if (mode != Mode::Trip) return {};
  if (navigation_ && navigation_->stop != StopCategory::None) return "The navigation program's stop stands.";
  if (seen_.measurement.depth_um >= limits::kReturned_um) return "The needle has not returned.";
  const safety::Hazard worst = seen_.supervisor.worst;
  const bool ends_with_it = worst == safety::Hazard::EStop || worst == safety::Hazard::PanelUntested;
  return worst == safety::Hazard::None || ends_with_it
             ? ""
             : fmt::format("Still there: {}.", hazard_text(worst, seen_.panel_unread_ms));
}

events::Disabled OperatorSession::disabled() const {
  const Mode mode = seen_.supervisor.permit.mode;
  events::Disabled why;
  why.arm = why_no_arm();
  why.insert = why_no_insert();
  why.judge = why_no_judgement();
  why.accept = why_no_acceptance();
  if (!hv_permitted() || mode == Mode::Retract)
    why.retract = mode == Mode::Retract ? "The needle is being retracted." : "High voltage is off.";
  why.reset = why_no_reset();
  if (plan() == nullptr)
    why.plan = p_SE_ && p_ST_ ? "There is no plan to confirm." : "Set entry and target first.";
  else if (confirmed_)
    why.plan = "It is confirmed.";
  return why;
}

}  // namespace biopsy::robot
