// What the page asked for: done, or refused with the reason.
#include <fmt/format.h>

#include <algorithm>

#include "planner/plan/seal.hpp"
#include "robot/common/config_error.hpp"
#include "robot/console/console_labels.hpp"
#include "robot/console/operator_run.hpp"
#include "robot/console/operator_session.hpp"
#include "robot/console/server/picked_point.hpp"
#include "safety/types/hazards.hpp"

namespace biopsy::robot {

namespace commands = console::commands;
namespace events = console::events;

namespace {

events::Answer done(std::uint32_t id) {
  return {id, true, {}, {}, {}, {}};
}

}  // namespace

std::optional<events::Answer> OperatorSession::ask(console::Client client, const commands::Any& asked,
                                                   std::int64_t now_us) {
  now_us_ = now_us;
  if (const auto* stop = std::get_if<commands::Stop>(&asked)) return on(*stop);  // anyone may
  if (const auto* take = std::get_if<commands::TakeControl>(&asked)) return on(client, *take);
  const bool controls = lease_.is_held_by(client);
  if (const auto* beat = std::get_if<commands::Beat>(&asked)) {
    if (controls) hold_.beat(beat->token, beat->page_ms, now_us);
    return std::nullopt;
  }
  if (const auto* release = std::get_if<commands::Release>(&asked)) {
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
      asked);
}

OperatorSession::Answer OperatorSession::on(console::Client client, const commands::TakeControl& asked) {
  return lease_.take(client) ? done(asked.id) : refusal(asked.id, Refused::NotController);
}

OperatorSession::Answer OperatorSession::on(const commands::OpenSeries& asked) {
  if (hv_permitted()) return refusal(asked.id, Refused::NeedleInUse);
  if (asked.series_uid != prepared_.image.identity.series_uid) {
    if (run_ && !run_->ended) return refusal(asked.id, Refused::NotNow, "the last run is not over");
    if (const auto why = series_.begin(asked.series_uid)) return refusal(asked.id, Refused::NoSeries, *why);
    unconfirm();
    return done(asked.id);
  }
  opened_ = true;
  ++version_;
  return done(asked.id);
}

OperatorSession::Answer OperatorSession::on(const commands::SetPoint& asked) {
  if (!opened_) return refusal(asked.id, Refused::NoSeries);
  if (hv_permitted()) return refusal(asked.id, Refused::NeedleInUse);
  const auto picked = console::picked_point(prepared_.image, asked);
  if (const auto* why = std::get_if<std::string>(&picked))
    return refusal(asked.id, Refused::WrongPlace, *why);
  unconfirm();
  (asked.mark == console::Mark::Entry ? p_SE_ : p_ST_) = std::get<Point>(picked);
  if (p_SE_ && p_ST_) {
    prepared_.target.p_SE = *p_SE_;
    prepared_.target.p_ST = *p_ST_;
    try {
      plan_to_target(prepared_);
    } catch (const ConfigError& error) {  // a path that leaves the label map
      prepared_.plan = PlanRefusal{error.what_is_wrong, error.remedy};
    }
  }
  return done(asked.id);
}

OperatorSession::Answer OperatorSession::on(const commands::ConfirmPlan& asked) {
  if (plan() == nullptr) return refusal(asked.id, Refused::NoPlan);
  if (!is_shown(asked.seal)) return refusal(asked.id, Refused::OldPlan);
  if (hv_permitted()) return refusal(asked.id, Refused::NeedleInUse);
  confirmed_ = true;
  ++version_;
  return done(asked.id);
}

OperatorSession::Answer OperatorSession::on(const commands::SetTick& asked) {
  if (!confirmed_) return refusal(asked.id, Refused::NoPlan, "confirm the plan first");
  if (!is_shown(asked.seal)) return refusal(asked.id, Refused::OldPlan);
  if (hv_permitted()) return refusal(asked.id, Refused::NeedleInUse);
  ticks_[static_cast<std::size_t>(asked.tick)] = asked.on;
  ticked_us_ = now_us_;
  confirmations_due_ = true;
  return done(asked.id);
}

OperatorSession::Answer OperatorSession::on(const commands::Press& asked) {
  const bool arm = asked.button == console::Button::Arm;
  if (arm && !simulated_) return refusal(asked.id, Refused::OnlyOnDevice);
  const std::string why = arm ? why_no_arm() : why_no_insert();
  if (!why.empty()) return refusal(asked.id, Refused::NotNow, why);
  if (!hold_.press(asked.token, asked.page_ms, now_us_)) return refusal(asked.id, Refused::TokenSpent);
  button_ = asked.button;
  return done(asked.id);
}

// Held against whatever else is asked, until high voltage is off.
OperatorSession::Answer OperatorSession::on(const commands::Stop& asked) {
  hold_.drop();
  stopped_ = true;
  stop_until_us_ = now_us_ + kStopLasts_us;
  if (run_ && !run_->ended && !run_->completed) run_->stopped_because = "STOP was pressed";
  return done(asked.id);
}

void OperatorSession::let_back() {
  hold_.drop();
  if (run_ && run_->completed)
    finish_ = true;
  else
    retract_until_us_ = now_us_ + kStopLasts_us;
}

OperatorSession::Answer OperatorSession::on(const commands::Retract& asked) {
  if (!hv_permitted()) return refusal(asked.id, Refused::NotNow, disabled().retract);
  let_back();
  return done(asked.id);
}

OperatorSession::Answer OperatorSession::on(const commands::Reset& asked) {
  if (!simulated_) return refusal(asked.id, Refused::OnlyOnDevice);
  if (seen_.supervisor.permit.mode != Mode::Trip) return refusal(asked.id, Refused::NotNow, disabled().reset);
  stop_until_us_ = 0;
  reset_until_us_ = now_us_ + kKeyTurned_us;
  return done(asked.id);
}

OperatorSession::Answer OperatorSession::on(const commands::Judge& asked) {
  const std::string why = why_no_judgement();
  if (!why.empty() || run_->imaged != asked.stage) return refusal(asked.id, Refused::NotNow, why);
  const auto& check = run_->notes.record().stages[asked.stage].check;
  if (asked.judgement == console::Judgement::Accept) {
    if (check->verdict != DepthVerdict::Accept)
      return refusal(asked.id, Refused::NotNow, "the image does not show the tip where it should be");
    run_->accepted = asked.stage;
    run_->completed = run_->is_last(asked.stage);
    return done(asked.id);
  }
  adjusts_ = asked.judgement == console::Judgement::Adjust;
  run_->stopped_because = adjusts_ ? "adjusted by the person after the image" : "rejected by the person";
  let_back();
  return done(asked.id);
}

console::Step OperatorSession::step() const {
  using console::Step;
  const Mode mode = seen_.supervisor.permit.mode;
  const bool stage_end = mode == Mode::Hold && seen_.supervisor.stage_done;
  if (hv_permitted()) {
    const bool waits = run_ && stage_end && run_->accepted != seen_.supervisor.stage;
    return waits || (run_ && run_->completed) ? Step::Confirm : Step::Insert;
  }
  if (run_ && !run_->ended && run_->moved) return Step::Confirm;
  if (!opened_) return Step::Image;
  if (!confirmed_) return Step::Plan;
  if (run_ && std::none_of(ticks_.begin(), ticks_.end(), [](bool tick) { return tick; }))
    return Step::Confirm;
  return all_ticked() ? Step::Arm : Step::Check;
}

std::string OperatorSession::why_no_arm() const {
  const Mode mode = seen_.supervisor.permit.mode;
  if (!confirmed_) return "Confirm the plan first.";
  if (hv_permitted()) return "It is armed.";
  if (run_ && !run_->ended) return "The last run is not over: judge its image.";
  if (!all_ticked()) return "CycleRecord all three checks first.";
  if (mode == Mode::Trip) return "Stopped: Reset first.";
  if (mode == Mode::Lock) return "Locked: service only.";
  if (mode != Mode::Ready) return fmt::format("Not ready yet: {}.", safety::name_of(seen_.supervisor.worst));
  return simulated_ ? "" : "Turn the arm key on the device.";
}

std::string OperatorSession::why_no_insert() const {
  const Mode mode = seen_.supervisor.permit.mode;
  if (mode == Mode::Armed || mode == Mode::Active) return {};
  if (mode != Mode::Hold) return "Arm first.";
  if (!seen_.supervisor.stage_done) return {};
  if (!run_ || run_->is_last(seen_.supervisor.stage))
    return "The plan is done: look at the image, then Retract.";
  return run_->accepted == seen_.supervisor.stage ? "" : "Accept the image first.";
}

std::string OperatorSession::why_no_judgement() const {
  if (!run_ || !run_->imaged) return "No image was taken yet.";
  if (!run_->is_checked(*run_->imaged)) return "Wait for the image.";
  if (run_->accepted == run_->imaged) return "It is accepted.";
  return run_->ended || !run_->stopped_because.empty() ? "This run is over." : "";
}

events::Disabled OperatorSession::disabled() const {
  const Mode mode = seen_.supervisor.permit.mode;
  events::Disabled why;
  why.arm = why_no_arm();
  why.insert = why_no_insert();
  why.judge = why_no_judgement();
  if (!hv_permitted() || mode == Mode::Retract) why.retract = "No voltage: the needle is back or on its way.";
  if (mode != Mode::Trip)
    why.reset = mode == Mode::Lock ? "Locked: service only." : "Nothing to reset.";
  else if (!simulated_)
    why.reset = "Turn the reset key on the device.";
  else if (waits_for_plan(seen_.supervisor.worst))
    why.reset = "Confirm the plan and tick the three checks first.";
  if (plan() == nullptr)
    why.plan = p_SE_ && p_ST_ ? "There is no plan to confirm." : "Set entry and target first.";
  else if (confirmed_)
    why.plan = "It is confirmed.";
  return why;
}

}  // namespace biopsy::robot
