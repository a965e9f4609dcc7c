// What the console makes of a navigation program's wishes.
#include <fmt/format.h>

#include <algorithm>

#include "planner/plan/registration.hpp"
#include "robot/common/config_error.hpp"
#include "robot/console/console_labels.hpp"
#include "robot/console/operator_run.hpp"
#include "robot/console/operator_session.hpp"

namespace biopsy::robot {

namespace {

constexpr std::size_t kWhyMax = 300;  // of the message

std::vector<double> rows_of(const NavigationRequest& request) {
  std::vector<double> rows(16, 0.0);
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column)
      rows[4 * row + column] = request.rotation_ppb[3 * row + column] * 1e-9;
    rows[4 * row + 3] = request.origin_um[row] * 1e-3;
  }
  rows[15] = 1.0;
  return rows;
}

Point lps_of(const std::array<std::int32_t, 3>& ras_um) {
  return lps_from_ras(Point(ras_um[0], ras_um[1], ras_um[2]) * 1e-3);
}

// A point of another frame than the image's lies outside it, as a rule.
bool is_inside(const Grid& grid, const Point& p_S) {
  const Point voxel = grid.X_SI.inverse() * p_S;
  return (voxel.array() >= -0.5).all() && (voxel.array() <= grid.size.cast<double>().array() - 0.5).all();
}

}  // namespace

NavigationReply OperatorSession::navigate(const std::optional<NavigationRequest>& request,
                                          std::int64_t now_us) {
  now_us_ = now_us;
  if (!request) {  // it has gone: a stop where it had asked for the motion that there is
    if (navigation_ && navigation_->wants_motion && hv_permitted()) {
      retract();
      if (run_ && !run_->ended) run_->stopped_because = "the navigation program has gone";
    }
    navigation_.reset();
    return {};
  }
  take_stop(*request);
  take_proposal(*request);
  const bool changed = navigation_ != request;
  navigation_ = request;
  if (changed && request->proposal != proposal_) ++version_;
  const bool shown = shows_proposal();
  NavigationReply reply;
  reply.proposal = proposal_;
  reply.planned = shown;
  reply.confirmed = shown && confirmed_ && (all_ticked() || hv_permitted());
  reply.steps = shown ? static_cast<std::uint32_t>(plan()->steps.size()) : 0;
  reply.why = shown ? why_no_arm() : proposal_refused_;
  if (reply.why.empty() && !shown) reply.why = "other points were set at the console";
  reply.why.resize(std::min(reply.why.size(), kWhyMax));
  return reply;
}

bool OperatorSession::shows_proposal() const {
  return proposal_ != 0 && proposal_refused_.empty() && plan() != nullptr && plan()->seal == proposal_seal_;
}

// The request itself is the level of the stop; see inputs(). Here is what it means for press and run.
void OperatorSession::take_stop(const NavigationRequest& request) {
  const StopCategory before = navigation_ ? navigation_->stop : StopCategory::None;
  if (request.stop <= before) return;
  if (request.stop == StopCategory::C0Off)
    on(console::commands::Stop{});  // without high voltage it stands until Reset
  else
    hold_.cancel();
  if (run_ && !run_->ended && !run_->completed && hv_permitted())
    run_->stopped_because = "stopped by the navigation program";
}

void OperatorSession::take_proposal(const NavigationRequest& request) {
  if (request.proposal == proposal_) return;
  // The last run ends by itself within seconds: the answer waits for it, as the navigation program does.
  const bool is_ending = !hv_permitted() && run_ && !run_->ended && !run_->is_undecided();
  if (request.proposal != 0 && is_ending) return;
  if (request.proposal == 0 && shows_proposal() && !hv_permitted()) unconfirm();  // taken back
  proposal_ = request.proposal;
  proposal_refused_ = proposal_ == 0 ? "" : plan_proposal(request);
  if (proposal_ != 0 && proposal_refused_.empty()) proposal_seal_ = plan()->seal;
}

// Why there is no plan to it, or nothing.
std::string OperatorSession::plan_proposal(const NavigationRequest& request) {
  if (hv_permitted() || (run_ && !run_->ended)) return "the needle is in use, or its last run is not over";
  if (series_.reading() != "") return "a series is being read at the console";
  const Point p_SE = lps_of(request.origin_um), p_ST = lps_of(request.target_um);
  if (!is_inside(prepared_.image.grid, p_SE) || !is_inside(prepared_.image.grid, p_ST))
    return "entry or target lies outside the image that is open at the console";
  unconfirm();
  if (!own_pose_) own_pose_ = Pose{prepared_.given.fiducials, prepared_.given.transform};
  prepared_.given.fiducials.clear();
  prepared_.given.transform = rows_of(request);
  prepared_.target.p_SE = p_SE;
  prepared_.target.p_ST = p_ST;
  p_SE_ = p_SE;
  p_ST_ = p_ST;
  opened_ = true;
  try {
    plan_to_target(prepared_);
  } catch (const ConfigError& error) {
    prepared_.plan = PlanRefusal{error.what_is_wrong, error.remedy};
  }
  if (const auto* refusal = std::get_if<PlanRefusal>(&prepared_.plan))
    return fmt::format("{}; {}", refusal->what, refusal->remedy);
  return {};
}

// A person's points are planned with the case's own registration.
void OperatorSession::restore_pose() {
  if (!own_pose_) return;
  prepared_.given.fiducials = own_pose_->fiducials;
  prepared_.given.transform = own_pose_->transform;
  own_pose_.reset();
}

std::vector<console::events::Alarm> OperatorSession::navigation_alarms() const {
  if (!navigation_) return {};
  std::vector<console::events::Alarm> alarms;
  if (navigation_->stop != StopCategory::None) alarms.push_back(navigation_stop_notice());
  if (navigation_->wants_motion) alarms.push_back(motion_notice());
  if (shows_proposal() && !confirmed_) alarms.push_back(proposal_notice());
  return alarms;
}

}  // namespace biopsy::robot
