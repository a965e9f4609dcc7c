#include "robot/live/session/live_robot.hpp"

#include "planner/plan/seal.hpp"
#include "robot/live/realtime/tick_clock.hpp"

namespace biopsy::robot {
namespace {

constexpr std::int64_t kSpeakEvery_us = 20'000;          // a fifth of what hold-to-run forgives
constexpr std::int64_t kHeldWithoutAsking_us = 100'000;  // as long as the supervisor itself waits
constexpr int kLetBack_ticks = 600;                      // twice a C1 ramp
constexpr std::chrono::milliseconds kListen{5};
constexpr std::chrono::seconds kSilence{1};

OperatorAct act_of(const World& world) {
  OperatorAct act;
  act.token = world.press.token;
  act.held = world.press.held;
  act.stop = world.stop;
  act.finish = world.finish;
  act.acquiring = world.acquiring;
  act.arm = world.remote_arm;
  act.reset = world.remote_reset;
  act.patient_motion_um = world.patient_motion_um;
  return act;
}

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
  thread_ = std::jthread([this](const std::stop_token& stop) { listen(stop); });
}

LiveRobot::~LiveRobot() = default;

void LiveRobot::send_plan(const Plan& plan, const std::array<std::uint64_t, 2>& confirmed) {
  plans_.write({++plans_sent_, planner::canonical_bytes(plan), plan.seal, confirmed});
  const std::lock_guard lock(mutex_);
  plan_tag_ = planner::plan_tag(plan);
}

std::optional<CycleSample> LiveRobot::tick(const World& world) {
  std::unique_lock lock(mutex_);
  world_ = world;
  asked_us_ = realtime::monotonic_ns() / 1000;
  if (!came_.wait_for(lock, kSilence, [this] { return !beats_.empty(); })) return std::nullopt;
  const CycleSample beat = beats_.front();
  beats_.pop_front();
  return beat;
}

void LiveRobot::let_back() {
  World back;
  back.stop = StopCategory::C1Ramp;
  for (int ticks = 0; ticks < kLetBack_ticks; ++ticks) {
    const std::optional<CycleSample> beat = tick(back);
    if (!beat || !beat->tick.supervisor.permit.hv_enable) return;
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
    speak(now_us);
    board_.look(now_us);
    heartbeat_.beat(now_us);
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < kCount<Process>; ++i) health_[i] = board_.of(static_cast<Process>(i), now_us);
  }
}

// The tick of the last measurement, once the next one says what was then put out.
CycleSample LiveRobot::beat_of(const Measurement& next) const {
  CycleSample beat;
  CycleRecord& tick = beat.tick;
  tick.measurement = measured_;
  tick.request = request_;
  tick.drive_mV = next.command_mV;
  safety::SupervisorOutput& supervisor = tick.supervisor;
  supervisor.permit = permit_;
  supervisor.permit.mode = decision_.mode;
  supervisor.permit.stop = decision_.stop;
  supervisor.event = static_cast<safety::Event>(decision_.event);
  supervisor.worst = static_cast<safety::Hazard>(decision_.worst);
  supervisor.reason = static_cast<safety::Hazard>(decision_.reason);
  supervisor.refusal = static_cast<safety::Refusal>(decision_.refusal);
  supervisor.stage = decision_.stage;
  supervisor.stage_done = decision_.stage_done;
  supervisor.image_allowed = decision_.image_allowed;
  supervisor.image_disturbed = decision_.image_disturbed;
  beat.truth = {truth_.tip_nm * 1e-6, truth_.plate_b_nm * 1e-6, truth_.layers_entered};
  beat.setpoint = from_um(request_.setpoint_um);
  return beat;
}

void LiveRobot::gather() {
  permits_.take_newest(permit_);
  decisions_.take_newest(decision_);
  requests_.take_newest(request_);
  truths_.take_newest(truth_);
  Measurement next;
  while (measurements_.take(next)) {
    if (measured_.seq != 0) {
      if (next.seq > measured_.seq + 1) lost_ += next.seq - measured_.seq - 1;
      const CycleSample beat = beat_of(next);
      const std::lock_guard lock(mutex_);
      beats_.push_back(beat);
    }
    measured_ = next;
  }
  came_.notify_one();
}

void LiveRobot::speak(std::int64_t now_us) {
  World world;
  std::uint64_t plan_tag = 0;
  std::int64_t asked_us = 0;
  {
    const std::lock_guard lock(mutex_);
    world = world_;
    asked_us = asked_us_;
    plan_tag = plan_tag_;
  }
  if (panel_)
    panel_->set({.arm_key = world.arm,
                 .reset_key = world.reset,
                 .estop_a_closed = world.estop_closed,
                 .estop_b_closed = world.estop_closed,
                 .bench_key = world.bench_confirmed});
  OperatorAct act = act_of(world);
  // A person whose program stands still holds nothing: this thread must not do it for them.
  if (now_us - asked_us > kHeldWithoutAsking_us) act.held = false;
  act.seq = said_.seq;
  if (act != said_ || now_us - spoken_us_ >= kSpeakEvery_us) {
    ++act.seq;
    acts_.write(act);
    said_ = act;
    spoken_us_ = now_us;
  }
  const bool news = world.depth_accepted != judged_.accepted || world.accepted_stage != judged_.stage ||
                    plan_tag != judged_.plan_tag;
  if (!news) return;
  judged_ = {judged_.seq + 1, plan_tag, world.accepted_stage, world.depth_accepted};
  verdicts_.write(judged_);
}

}  // namespace biopsy::robot
