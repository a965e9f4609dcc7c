// Supervisor, evidence and gate as shipped around a stage, with any field of any message spoilt at any time:
// the loop stays total, its counters bounded, and a hazard of C0 leaves no voltage behind the tick.
#include <cstdlib>
#include <vector>

#include "tests/safety/rig.hpp"
#include "tests/verification/fuzz/safety_values.hpp"

namespace {

using namespace biopsy;
using namespace biopsy::fuzz;
using safety::Rig;

// One healthy loop in every mode, made once.
const std::vector<Rig>& rigs() {
  static const std::vector<Rig> made = [] {
    std::vector<Rig> all(safety::kModes);
    for (std::size_t mode = 0; mode < all.size(); ++mode) all[mode].go_to(static_cast<Mode>(mode));
    return all;
  }();
  return made;
}

void corrupt(Feed& feed, safety::SupervisorInputs& s) {
  switch (feed.any<std::uint8_t>() % 8) {
    case 0:
      return fill(feed, s.measurement);
    case 1:
      return feed.fill(s.measurement.depth_um, s.measurement.laser_code, s.measurement.laser_valid,
                       s.measurement.depth_b_um, s.measurement.laser_b_valid);
    case 2:
      return feed.fill(s.measurement.monitor_mV, s.measurement.current_nA, s.measurement.command_mV);
    case 3:
      return feed.fill(s.measurement.seq, s.measurement.time_us, s.measurement.answer,
                       s.measurement.answered_seq);
    case 4:
      return fill(feed, s.request);
    case 5:
      return fill(feed, s.permit);
    case 6:
      return feed.fill(s.now_us, s.writers, s.estop_a_closed, s.estop_b_closed, s.panel_read, s.relay_closed,
                       s.acquiring);
    default:
      return feed.fill(s.log_backlog_ms, s.patient_motion_um, s.tissue_residual_um, s.plan_tag, s.config_tag,
                       s.confirmed_tag[0], s.bench_confirmed);
  }
}

void claim_bounded(const safety::EvidenceMemory& m) {
  using namespace biopsy::safety;
  const LinkMonitor& link = m.link;
  claim(link.stale_ticks <= kStale_ticks + 1 && link.silent_ticks <= kStale_ticks + 1,
        "silence counts to its limit");
  claim(link.order_score >= 0 && link.order_score <= kScoreMax && link.answer_score >= 0 &&
            link.answer_score <= kScoreMax,
        "scores stay in their range");
  claim(link.miss_score >= 0 && link.miss_score <= kMissMax, "missed periods count to their limit");
  claim(link.residual_ticks <= kWrongModel_ticks && m.panel.differs_ticks <= kEStopDisagree_ticks + 1 &&
            m.panel.relay_ticks <= kRelay_ticks + 1 && m.panel.open_ticks <= kRelay_ticks,
        "link counters stop at their limits");
  const VoltageMonitor& drive = m.drive;
  claim(drive.flips >= 0 && drive.flips <= 4 && drive.off_ticks <= kResidual_ticks &&
            drive.zero_ticks <= kZero_ticks,
        "drive counters stop at their limits");
  claim(std::abs(drive.signed_mVms) <= drive.total_mVms + 2 * kForget_ticks * 20,
        "the balance is at most the charge");
  const DepthMonitor& depth = m.depth;
  claim(depth.not_back_ticks <= kNotBack_ticks && depth.implausible_ticks <= kImplausible_ticks &&
            depth.same_code_ticks <= kFrozen_ticks && depth.dropout_score <= kDropoutTrip,
        "depth counters stop at their limits");
  claim(depth.window.block >= 0 && depth.window.block < DriveWindow::kBlocks,
        "the window stays inside itself");
}

void tick(Rig& rig) {
  const std::int64_t was_mV = std::abs(std::int64_t{rig.gate_state.drive_mV});
  rig.tick();
  const std::int64_t is_mV = std::abs(std::int64_t{rig.gate_state.drive_mV});
  claim_sound(rig.output.permit);
  claim_bounded(rig.memory);
  claim(is_mV <= limits::kDriveMax_mV, "never above the hard limit");
  claim(is_mV <= was_mV || rig.state.mode == Mode::Active, "only Active rises");
  const bool c0 = (rig.evidence.hazards() & safety::hazards_with(StopCategory::C0Off)) != 0;
  claim(!c0 || (is_mV == 0 && !rig.gate_state.enabled), "C0 leaves no voltage behind the tick");
}

}  // namespace

FUZZ(lockstep) {
  Feed feed(bytes);
  Rig rig = rigs()[feed.any<std::uint8_t>() % safety::kModes];
  int ticks = 0;
  while (!feed.empty() && ticks < 2'000) {
    const auto what = feed.any<std::uint8_t>();
    rig.on_observation = [](safety::SupervisorInputs&) {};
    if (what & 1) {
      rig.on_observation = [&](safety::SupervisorInputs& seen) { corrupt(feed, seen); };
    }
    if (what & 2) rig.press();
    if (what & 4) rig.release();
    rig.arm = (what & 8) != 0;
    rig.reset = (what & 16) != 0;
    rig.reached = (what & 32) != 0;
    if (what & 64) feed.fill(rig.wanted_mV), rig.wanted_mV %= limits::kDriveMax_mV;
    const int run = what & 128 ? 1 + feed.any<std::uint8_t>() : 1;
    for (int i = 0; i < run; ++i, ++ticks) tick(rig);
  }
}
