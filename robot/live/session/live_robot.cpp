#include "robot/live/session/live_robot.hpp"

#include "planner/plan/seal.hpp"
#include "robot/common/operator_name.hpp"
#include "robot/live/realtime/tick_clock.hpp"

namespace biopsy::robot {
namespace {

constexpr std::int64_t kSendEvery_us = 20'000;           // a fifth of the hold-to-run timeout
constexpr std::int64_t kHeldWithoutAsking_us = 100'000;  // the supervisor's own timeout
constexpr int kRetract_ticks = 600;                      // twice a C1 ramp
constexpr std::chrono::milliseconds kListen{5};
constexpr std::chrono::seconds kSilence{1};

}  // namespace

LiveRobot::LiveRobot(const transport::Participant& bus, const std::filesystem::path& panel,
                     std::uint64_t config_tag)
    : measurements_(bus),
      permits_(bus),
      decisions_(bus),
      requests_(bus),
      truths_(bus),
      acts_(bus),
      plans_(bus),
      verdicts_(bus),
      wait_set_(bus),
      heartbeat_(bus, Process::Person, config_tag),
      board_(bus) {
  if (!panel.empty()) panel_.emplace(panel);
  wait_set_.add(measurements_);
  heartbeat_.health().ready = true;
  heartbeat_.note(operator_name());
  thread_ = std::jthread([this](const std::stop_token& stop) { listen(stop); });
}

LiveRobot::~LiveRobot() = default;

void LiveRobot::send_plan(const Plan& plan, const std::array<std::uint64_t, 2>& confirmed) {
  plans_.write({++plans_sent_, planner::canonical_bytes(plan), plan.seal, confirmed});
  const std::lock_guard lock(mutex_);
  plan_tag_ = planner::plan_tag(plan);
}

std::optional<CycleSample> LiveRobot::tick(const OperatorInputs& inputs) {
  std::unique_lock lock(mutex_);
  inputs_ = inputs;
  asked_us_ = realtime::monotonic_ns() / 1000;
  if (!came_.wait_for(lock, kSilence, [this] { return !cycles_.empty(); })) return std::nullopt;
  CycleSample cycle = cycles_.front();
  cycles_.pop_front();
  cycle.newest = cycles_.empty();
  return cycle;
}

void LiveRobot::retract() {
  OperatorInputs inputs = OperatorInputs::idle();
  inputs.stop = StopCategory::C1Ramp;
  for (int ticks = 0; ticks < kRetract_ticks; ++ticks) {
    const std::optional<CycleSample> cycle = tick(inputs);
    if (!cycle || !cycle->record.supervisor.permit.hv_enable) return;
  }
}

std::array<Health, kCount<Process>> LiveRobot::health() const {
  const std::lock_guard lock(mutex_);
  return health_;
}

void LiveRobot::listen(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    wait_set_.wait(kListen);
    const std::int64_t now_us = realtime::monotonic_ns() / 1000;
    gather();
    send(now_us);
    board_.update(now_us);
    heartbeat_.beat(now_us);
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < kCount<Process>; ++i) health_[i] = board_.of(static_cast<Process>(i), now_us);
  }
}

// The tick of the last measurement, once the next one shows what was then put out.
CycleSample LiveRobot::cycle_of(const Measurement& next) const {
  CycleSample cycle;
  cycle.record.measurement = measured_;
  cycle.record.request = request_;
  cycle.record.drive_mV = next.command_mV;
  const Decision& decision = passed_ ? *passed_ : decision_;
  cycle.record.supervisor = supervisor_output(decision, permit_);
  cycle.record.supervisor.image_disturbed = disturbed_ || decision_.image_disturbed;
  cycle.record.panel_unread_ms = decision.panel_unread_ms;
  cycle.record.evidence.clear =
      safety::kAllHazards & ~safety::bit(cycle.record.supervisor.worst) &
      ~(decision.estop ? safety::bit(safety::Hazard::EStop) : 0);  // as far as is told
  cycle.truth = {truth_.tip_nm * 1e-6, truth_.plate_b_nm * 1e-6, truth_.layers_entered, truth_.active_faults};
  cycle.setpoint = from_um(request_.setpoint_um);
  return cycle;
}

void LiveRobot::gather() {
  permits_.take_newest(permit_);
  while (decisions_.take(decision_)) {
    if (decision_.mode == Mode::Retract || decision_.mode == Mode::Trip) passed_ = decision_;
    disturbed_ = disturbed_ || decision_.image_disturbed;
  }
  requests_.take_newest(request_);
  truths_.take_newest(truth_);
  Measurement next;
  while (measurements_.take(next)) {
    if (measured_.seq != 0) {
      if (next.seq > measured_.seq + 1) lost_ += next.seq - measured_.seq - 1;
      const CycleSample cycle = cycle_of(next);
      passed_.reset();
      disturbed_ = false;
      const std::lock_guard lock(mutex_);
      cycles_.push_back(cycle);
    }
    measured_ = next;
  }
  came_.notify_one();
}

void LiveRobot::send(std::int64_t now_us) {
  OperatorInputs inputs;
  std::uint64_t plan_tag = 0;
  std::int64_t asked_us = 0;
  {
    const std::lock_guard lock(mutex_);
    inputs = inputs_;
    asked_us = asked_us_;
    plan_tag = plan_tag_;
  }
  if (asked_us == 0) return;  // no operator yet
  if (panel_) panel_->set(panel_proof_.levels(panel_levels(inputs), decision_, now_us));
  OperatorAct act = operator_act(inputs);
  // An operator whose program stands still holds nothing: this thread must not do it for them.
  if (now_us - asked_us > kHeldWithoutAsking_us) act.held = false;
  DepthVerdictNote verdict = depth_verdict(inputs, plan_tag);
  verdict.seq = verdict_.seq;
  if (verdict != verdict_) {  // before the act: a press relies on it
    verdict.seq = verdict_.seq + 1;
    verdicts_.write(verdict);
    verdict_ = verdict;
  }
  act.seq = act_.seq;
  if (act == act_ && now_us - sent_us_ < kSendEvery_us) return;
  ++act.seq;
  acts_.write(act);
  act_ = act;
  sent_us_ = now_us;
}

}  // namespace biopsy::robot
