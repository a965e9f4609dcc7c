// The input-output relation of one part of the safety core, as a hash: relations NAME.
//
// "reachable steps" and "reachable gates" are all that the exploration can take: a proof at its abstraction.
// The mutants named after them take each step as well; the numbers of those that always did the same are
// printed. Each of the others is a long walk from the default state: every input is drawn, by a fixed seed,
// from the values around which the code decides (limits, one less, one more, zero, the ends of the type)
// mixed with likely ones, and every output goes into the hash. A mutant whose hash differs is not equivalent.
// Equal hashes are evidence over that walk, not over all inputs: the argument for the rest is the reason in
// equivalents.toml.
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>
#include <span>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "mutation.hpp"
#include "reachable.hpp"
#include "relation_hash.hpp"
#include "safety/challenge.hpp"
#include "safety/gate.hpp"
#include "safety/monitors/evidence.hpp"
#include "safety/monitors/panel_filter.hpp"
#include "safety/monitors/tissue_monitor.hpp"
#include "safety/supervisor.hpp"
#include "safety/types/limits.hpp"
#include "tests/safety/situation.hpp"

namespace biopsy::safety {
namespace {

constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max(), kLeast = -kMost - 1;
constexpr std::int32_t kVolts_mV[] = {kLeast,    -8'200'001, -8'000'001, -8'000'000, -1'000'000, -100'001,
                                      -100'000,  -1,         0,          1,          99'999,     100'000,
                                      100'001,   200'001,    999'999,    1'000'000,  3'999'999,  4'000'000,
                                      6'000'000, 8'000'000,  8'000'001,  8'200'000,  8'200'001,  kMost};
constexpr std::int32_t kSlews_mV[] = {kLeast, -1, 0, 1, 1'000, 20'000, 399'999, 400'000, 400'001, kMost};
constexpr std::int32_t kDepths_um[] = {kLeast, -1'000'001, -1'100, -101,  -100,   -1,    0,     1,
                                       100,    500,        999,    1'000, 1'001,  3'599, 3'600, 4'000,
                                       4'001,  5'000,      5'001,  6'001, 12'000, kMost};
constexpr std::int32_t kSteps_us[] = {-1'000, 0, 1, 4'999, 5'000, 5'001};

class Dice {
 public:
  explicit Dice(std::uint32_t seed) : random_(seed) {}
  bool one_in(std::uint32_t n) { return random_() % n == 0; }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(random_() % n); }
  std::int32_t of(std::span<const std::int32_t> values) { return values[random_() % values.size()]; }

 private:
  std::mt19937 random_;
};

PlanFacts plan_of(Dice& dice) {
  PlanFacts plan;
  plan.plan_tag = 1 + dice.below(2), plan.config_tag = 7;
  plan.depth_max_um = 4'000, plan.tissue_residual_max_um = 500;
  plan.step_count = dice.below(5), plan.band_count = dice.below(5);
  for (std::uint32_t i = 0; i < 5; ++i) {
    const auto n = static_cast<std::int32_t>(i);
    plan.steps[i] = {3'600 + 100 * n, 6'500'000 + 500'000 * n, 20'000, dice.one_in(2)};
    plan.bands[i] = {2'000'000 * n, 1'000 * n - 100, 1'000 * n + 100};
  }
  if (dice.one_in(4)) plan.bench_half_period_ticks = static_cast<std::int32_t>(dice.below(400));
  if (!dice.one_in(4)) return plan;
  plan.depth_max_um = dice.of(kDepths_um), plan.tissue_residual_max_um = dice.of(kDepths_um);
  plan.steps[0] = {dice.of(kDepths_um), dice.of(kVolts_mV), dice.of(kSlews_mV), true};
  plan.bands[1] = {dice.of(kVolts_mV), dice.of(kDepths_um), dice.of(kDepths_um)};
  return plan;
}

Permit permit_of(Dice& dice, const GateState& state) {
  Permit permit = state.permit;
  permit.session = dice.one_in(20) ? dice.below(4) : std::max(permit.session, 1U);
  permit.seq += dice.one_in(20) ? dice.below(5) - 2 : 1;
  permit.epoch = dice.below(20) == 0 ? dice.below(3) : permit.epoch;
  permit.ttl_us = dice.one_in(10) ? dice.of(kSteps_us) : limits::kPermitTtl_us;
  permit.hv_enable = !dice.one_in(6);
  permit.brake = dice.one_in(2);
  permit.mode = dice.one_in(4) ? static_cast<Mode>(dice.below(9)) : Mode::Active;
  permit.stop =
      permit.hv_enable && !dice.one_in(10) ? StopCategory::None : static_cast<StopCategory>(dice.below(4));
  permit.v_max_mV = dice.of(kVolts_mV);
  permit.slew_up_mV_per_tick = dice.of(kSlews_mV);
  permit.challenge = dice.below(1'000);
  return permit;
}

void hash_gate(Hash& hash) {
  Dice dice(1);
  GateState state;
  for (int i = 0; i < 150'000; ++i) {
    if (dice.one_in(300)) state = {};
    const Permit permit = permit_of(dice, state);
    const DriveRequest request{.seq = state.request_seq + (dice.one_in(10) ? dice.below(4) - 2 : 1),
                               .wanted_mV = dice.of(kVolts_mV),
                               .brake = dice.one_in(2)};
    const std::int64_t now_us = state.now_us + (dice.one_in(30) ? dice.of(kSteps_us) : 1'000);
    const GateResult result =
        gate(state, dice.one_in(8) ? nullptr : &request, dice.one_in(8) ? nullptr : &permit, now_us,
             dice.one_in(100) ? static_cast<std::int32_t>(dice.below(3)) : 1);
    state = result.state;
    hash.add(result.voltage.mV(), result.voltage.hv_enabled(), result.voltage.brake_on(), result.verdict,
             result.answer, result.answered_seq);
  }
}

Situation input_of(Dice& dice, const SupervisorState& state) {
  Situation input;
  input.now_us = dice.below(1'000);
  input.evidence.clear = kAllHazards;
  if (dice.one_in(30)) input.evidence.clear &= ~bit(static_cast<Hazard>(dice.below(kHazards)));
  const bool driven = state.mode == Mode::Active || state.mode == Mode::Hold || state.mode == Mode::Retract;
  input.evidence.zero_volts = driven ? dice.one_in(40) : !dice.one_in(40);
  input.evidence.needle_home = !dice.one_in(5);
  input.evidence.needle_back = !dice.one_in(5);
  input.evidence.image_disturbed = dice.one_in(5);
  input.measurement.brake_fitted = dice.one_in(2);
  input.evidence.locked = dice.one_in(3);
  input.evidence.still = dice.one_in(3);
  input.acquiring = dice.one_in(10);
  input.evidence.drive_mV = static_cast<std::int32_t>(dice.below(8'000'001));
  input.evidence.ceiling_mV = static_cast<std::int32_t>(dice.below(8'000'001));
  input.self_test = dice.one_in(20) ? static_cast<SelfTest>(dice.below(3)) : SelfTest::Passed;
  input.local_arm = dice.one_in(2), input.local_reset = dice.one_in(2);
  input.remote_arm = dice.one_in(20), input.remote_reset = dice.one_in(20);
  if (dice.one_in(40)) input.stop = static_cast<StopCategory>(dice.below(4));
  if (!dice.one_in(4)) input.motion = {state.token + dice.below(20) / 18, !dice.one_in(20)};
  if (dice.one_in(40)) input.motion.token = dice.below(3);
  input.request.step = dice.one_in(8) ? dice.below(4) : state.step;
  input.request.step_reached = dice.one_in(10);
  input.request.finished = dice.one_in(200);
  input.depth_accepted = !dice.one_in(3);
  input.accepted_step = dice.one_in(8) ? dice.below(4) : state.step;
  return input;
}

void hash_step(Hash& hash) {
  Dice dice(2);
  PlanFacts plan = plan_of(dice);
  SupervisorState state = started(5);
  for (int i = 0; i < 150'000; ++i) {
    if (dice.one_in(400)) state = started(5), plan = plan_of(dice);
    if (dice.one_in(100)) state.ms_in_mode += static_cast<std::int32_t>(dice.below(40) * 1'000);
    const auto [next, output] = step(plan, state, input_of(dice, state));
    const Permit& permit = output.permit;
    hash.add(permit.session, permit.epoch, permit.seq, permit.issued_us, permit.ttl_us, permit.mode,
             permit.stop, permit.hv_enable, permit.v_max_mV, permit.slew_up_mV_per_tick, permit.depth_max_um,
             permit.brake, permit.challenge);
    hash.add(output.event, output.worst, output.reason, output.refusal, output.step, output.step_done,
             output.image_allowed, output.image_disturbed, output.interlock_pulse);
    hash.add(next.last_event, next.token, next.ms_in_mode, next.ms_since_held, next.held_mV);
    state = next;
  }
}

// A stage that mostly obeys: what every detector sees in a procedure, spoilt in one field now and then.
class Course {
 public:
  explicit Course(std::uint32_t seed) : dice_(seed), plan_(plan_of(dice_)) {}

  void tick() {
    if (dice_.one_in(3'000)) seen_ = {}, memory_ = {}, plan_ = plan_of(dice_);
    if (dice_.one_in(300)) seen_.permit.mode = static_cast<Mode>(dice_.below(9)), drift_um_ = 0;
    if (dice_.one_in(150)) drift_um_ = static_cast<std::int32_t>(dice_.below(200)) - 100;
    if (dice_.one_in(250)) depth_um_ = dice_.of(kDepths_um) / 2;
    if (dice_.one_in(100)) drive_mV_ = dice_.of(kVolts_mV) / (1 + static_cast<std::int32_t>(dice_.below(2)));
    if (dice_.one_in(200)) spoil_ = dice_.below(29);
    if (dice_.one_in(400)) locked_ = !locked_;
    fill();
    if (dice_.below(6) != 0) corrupt();
  }

  const PlanFacts& plan() const { return plan_; }
  const SupervisorInputs& seen() const { return seen_; }
  EvidenceMemory& memory() { return memory_; }

 private:
  void fill() {
    Measurement& m = seen_.measurement;
    seen_.now_us += 1'000, m.time_us += 1'000;
    ++m.seq, ++seen_.request.seq, ++seen_.permit.seq;
    seen_.permit.session = 5;
    seen_.permit.hv_enable = m.hv_enabled =
        seen_.permit.mode >= Mode::Armed && seen_.permit.mode <= Mode::Retract;
    seen_.permit.v_max_mV = 8'000'000, seen_.permit.depth_max_um = 3'600;
    depth_um_ += drift_um_;
    m.depth_um = m.depth_b_um = depth_um_, m.laser_valid = m.laser_b_valid = true;
    ++m.laser_code;
    const bool negative = (seen_.request.seq / 250) % 2 != 0;
    m.command_mV = negative && drive_mV_ > kLeast ? -drive_mV_ : drive_mV_;
    m.brake_on = seen_.permit.brake = locked_;
    m.monitor_mV = m.command_mV, m.current_nA = 0, m.verdict = GateVerdict::Granted;
    m.answered_seq = seen_.permit.seq;
    m.answer = answer_to(challenge_of(5, m.answered_seq), m.command_mV, seen_.permit.mode, m.answered_seq);
    seen_.writers = 1, seen_.acquiring = dice_.one_in(2);
    seen_.estop_a_closed = seen_.estop_b_closed = seen_.panel_read = true;
    seen_.local_reset = dice_.one_in(50);
    const bool fed = seen_.permit.mode == Mode::Ready || hv_permitted(seen_.permit.mode);
    seen_.relay_closed = fed != (spoil_ == 27);
    seen_.log_backlog_ms = seen_.patient_motion_um = seen_.tissue_residual_um = 0;
    seen_.plan_tag = plan_.plan_tag, seen_.config_tag = plan_.config_tag;
    seen_.confirmed_tag = {plan_.plan_tag, plan_.plan_tag};
    seen_.bench_confirmed = true;
  }

  void corrupt() {
    Measurement& m = seen_.measurement;
    switch (spoil_) {
      case 0:
        seen_.now_us += dice_.of(kSteps_us);
        break;
      case 1:
        m.time_us += dice_.of(kSteps_us);
        break;
      case 2:
        m.seq -= 1;
        break;
      case 3:
        m.seq += dice_.below(3) - 1;
        break;
      case 4:
        seen_.request.seq -= 1;
        break;
      case 5:
        seen_.request.overruns += dice_.below(3);
        break;
      case 6:
        m.answered_seq -= dice_.below(8);
        break;
      case 7:
        m.answer ^= dice_.below(2);
        break;
      case 8:
        seen_.estop_a_closed = false;
        break;
      case 25:
        seen_.estop_a_closed = seen_.estop_b_closed = dice_.one_in(30);
        break;
      case 26:
        seen_.panel_read = dice_.one_in(2);
        break;
      case 9:
        seen_.estop_b_closed = dice_.one_in(3);
        break;
      case 10:
        seen_.tissue_residual_um = 499 + static_cast<std::int32_t>(dice_.below(3));
        break;
      case 11:
        seen_.patient_motion_um = dice_.of(kDepths_um);
        break;
      case 12:
        seen_.log_backlog_ms = dice_.of(kDepths_um);
        break;
      case 13:
        m.laser_valid = dice_.one_in(2);
        break;
      case 14:
        --m.laser_code;
        break;
      case 15:
        m.monitor_mV = dice_.of(kVolts_mV);
        break;
      case 16:
        m.current_nA = dice_.of(kVolts_mV);
        break;
      case 17:
        m.hv_enabled = !m.hv_enabled;
        break;
      case 18:
        seen_.permit.v_max_mV = dice_.of(kVolts_mV);
        break;
      case 19:
        seen_.plan_tag ^= dice_.below(2);
        break;
      case 20:
        seen_.writers = static_cast<std::int32_t>(dice_.below(3));
        break;
      case 21:
        m.laser_b_valid = dice_.one_in(2);
        break;
      case 22:
        m.depth_b_um += (dice_.one_in(2) ? 300 : -300) + static_cast<std::int32_t>(dice_.below(3)) - 1;
        break;
      case 23:
        m.laser_valid = dice_.one_in(8), m.depth_b_um -= 301;
        break;
      case 24:
        m.brake_on = dice_.one_in(2);
        break;
      default:
        break;
    }
  }

  Dice dice_;
  PlanFacts plan_;
  SupervisorInputs seen_;
  EvidenceMemory memory_;
  std::int32_t depth_um_ = 0, drift_um_ = 0, drive_mV_ = 0;
  bool locked_ = false;
  std::uint32_t spoil_ = 99;
};

void hash_evidence(Hash& hash) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    Course course(seed);
    TissueMonitor tissue;
    ContactFilter contact;
    KeyFilter key;
    for (int i = 0; i < 25'000; ++i) {
      course.tick();
      const Evidence evidence = assess(course.plan(), course.memory(), course.seen());
      hash.add(evidence.clear, evidence.zero_volts, evidence.needle_home, evidence.needle_back,
               evidence.image_disturbed, evidence.locked, evidence.still, evidence.drive_mV,
               evidence.ceiling_mV, evidence.interlock_opens, evidence.estop_reset, evidence.elapsed_ms,
               is_closed(contact, course.seen().estop_b_closed),
               is_turned(key, course.seen().estop_a_closed, course.seen().panel_read));
      Measurement sane = course.seen().measurement;
      sane.command_mV %= 10'000'000, sane.depth_um %= 1'000'000;
      hash.add(tissue_residual_um(course.plan(), tissue, sane));
    }
  }
}

void hash_plan(Hash& hash) {
  Dice dice(3);
  for (int i = 0; i < 100'000; ++i) {
    const PlanFacts plan = plan_of(dice);
    hash.add(is_plausible(plan), half_period_ticks(plan), lifting_drive_mV(plan));
    const DepthRange range = plausible_depth(plan, dice.of(kVolts_mV), dice.of(kVolts_mV));
    hash.add(range.low_um, range.high_um);
  }
}

// Complete: every mode with every event, every set of one or two hazards.
void hash_tables(Hash& hash) {
  for (int mode = 0; mode < 256; ++mode)
    for (int event = 0; event < 256; ++event)
      hash.add(next_mode(static_cast<Mode>(mode), static_cast<Event>(event)),
               hv_permitted(static_cast<Mode>(mode)));
  for (std::size_t a = 0; a < 64; ++a)
    for (std::size_t b = 0; b < 64; ++b) hash.add(worst_of(HazardSet{1} << a | HazardSet{1} << b));
  hash.add(worst_of(0), worst_of(~HazardSet{0}), locking_hazards(), kAllHazards);
  for (int stop = 0; stop < 4; ++stop) hash.add(hazards_with(static_cast<StopCategory>(stop)));
}

}  // namespace
}  // namespace biopsy::safety

int main(int argc, char** argv) {
  using namespace biopsy::safety;
  const std::pair<std::string_view, void (*)(Hash&)> relations[] = {{"gate", hash_gate},
                                                                    {"step", hash_step},
                                                                    {"evidence", hash_evidence},
                                                                    {"plan", hash_plan},
                                                                    {"tables", hash_tables}};
  const std::pair<std::string_view, void (*)(Hash&, std::vector<int>&)> walks[] = {
      {"reachable steps", walk_reachable_steps}, {"reachable gates", walk_reachable_gates}};
  mutation::limit_time(300'000);
  const std::string_view asked = argc > 1 ? argv[1] : "";
  Hash hash;
  std::vector<int> suspects;
  for (int i = 2; i < argc; ++i) suspects.push_back(std::atoi(argv[i]));
  bool known = false;
  for (const auto& [name, fill] : relations)
    if (name == asked && suspects.empty()) fill(hash), known = true;
  for (const auto& [name, walk] : walks)
    if (name == asked) walk(hash, suspects), known = true;
  if (!known) {
    std::fputs(
        "usage: relations gate|step|evidence|plan|tables\n"
        "       relations \"reachable steps\"|\"reachable gates\" [MUTANT ...]\n",
        stderr);
    return 2;
  }
  std::printf("%016llx\n", static_cast<unsigned long long>(hash.value()));
  for (const int alike : suspects) std::printf("%d\n", alike);
  return 0;
}
