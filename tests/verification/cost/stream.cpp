#include "tests/verification/cost/stream.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <type_traits>

#include "robot/common/in_parallel.hpp"
#include "safety/types/limits.hpp"
#include "tests/safety/situation.hpp"

namespace biopsy::fault_injection {
namespace {

static_assert(std::is_trivially_copyable_v<TickInput> && std::is_trivially_copyable_v<safety::PlanFacts>);

safety::PlanFacts largest_plan() {
  safety::PlanFacts plan;
  plan.plan_tag = plan.config_tag = 1;
  plan.depth_max_um = limits::kStroke_um;
  plan.tissue_residual_max_um = 500;
  plan.step_count = safety::kMaxSteps;
  plan.band_count = safety::kMaxBands;
  plan.steps.fill({limits::kStroke_um, limits::kDriveMax_mV, 80'000, true});
  for (std::size_t i = 0; i < safety::kMaxBands; ++i) {
    const auto step = static_cast<std::int32_t>(i);
    plan.bands[i] = {step * 250'000, step * 100, 2'000 + step * 300};
  }
  return plan;
}

Mode any_mode(Draw& draw) {
  return static_cast<Mode>(draw.whole(0, static_cast<std::int32_t>(Mode::Lock)));
}

// Mostly the next sound message, often something else.
Measurement any_measurement(Draw& draw, const Measurement& before) {
  Measurement m = before;
  m.seq += static_cast<std::uint32_t>(draw.whole(0, 20) == 0 ? draw.whole(0, 3) : 1);
  m.time_us += draw.whole(0, 40) == 0 ? draw.whole(-3'000, 9'000) : 1'000;
  m.depth_um = draw.whole(-2'000, 14'000);
  m.laser_code = draw.whole(0, 3) == 0 ? before.laser_code : m.depth_um;
  m.laser_valid = draw.whole(0, 6) != 0;
  m.depth_b_um = draw.coin() ? m.depth_um : draw.whole(-2'000, 14'000);
  m.laser_b_valid = draw.whole(0, 6) != 0;
  m.command_mV = draw.whole(-9'000'000, 9'000'000);
  m.monitor_mV = draw.coin() ? m.command_mV : draw.whole(-9'000'000, 9'000'000);
  m.current_nA = draw.whole(-40'000'000, 40'000'000);
  m.hv_enabled = draw.coin();
  m.answer = static_cast<std::uint32_t>(draw.bits());
  m.answered_seq = m.seq;
  m.verdict = draw.whole(0, 9) == 0 ? GateVerdict::SecondWriter : GateVerdict::Granted;
  return m;
}

Permit any_permit(Draw& draw, std::uint32_t seq) {
  Permit permit;
  permit.session = 1;
  permit.epoch = 1;
  permit.seq = seq;
  permit.ttl_us = limits::kPermitTtl_us;
  permit.mode = any_mode(draw);
  permit.stop = draw.coin() ? StopCategory::None : StopCategory::C1Ramp;
  permit.hv_enable = draw.whole(0, 4) != 0;
  permit.v_max_mV = draw.whole(0, 9'000'000);
  permit.slew_up_mV_per_tick = draw.whole(0, 500'000);
  permit.depth_max_um = draw.whole(0, 12'000);
  return permit;
}

}  // namespace

std::vector<Stream> recorded_streams(const NominalModels& models, std::size_t classes) {
  std::vector<FaultClass> faults = all_faults();
  faults.resize(std::min(classes, faults.size()));
  std::vector<Stream> streams(faults.size());
  in_parallel(faults.size(), [&](std::size_t i) {
    Campaign campaign{models};
    campaign.observer = [&stream = streams[i]](
                            const safety::PlanFacts& facts, const safety::SupervisorInputs& seen,
                            const safety::Situation& asked, const robot::GateInputs& given) {
      stream.facts = facts;
      TickInput tick;
      tick.seen = seen;
      tick.asked = asked;
      tick.permit_arrives = given.permit.seq != 0;
      if (given.permit.seq != 0) tick.permit = given.permit;
      if (given.request.seq != 0) tick.request = given.request;
      tick.gate_us = given.now_us;
      tick.writers = given.writers;
      stream.ticks.push_back(tick);
    };
    run_one(campaign, faults[i], i);
  });
  return streams;
}

Stream random_stream(std::uint64_t seed, std::size_t ticks) {
  Draw draw(seed);
  Stream stream{largest_plan(), {}};
  TickInput tick;
  for (std::size_t k = 1; k <= ticks; ++k) {
    const auto seq = static_cast<std::uint32_t>(k);
    tick.seen.now_us += draw.whole(0, 50) == 0 ? 7'000 : 1'000;
    tick.seen.measurement = any_measurement(draw, tick.seen.measurement);
    tick.seen.request.seq += draw.whole(0, 5) != 0;
    tick.seen.request.overruns += draw.whole(0, 30) == 0;
    tick.seen.permit = any_permit(draw, seq);
    tick.seen.writers = 1;
    tick.seen.estop_a_closed = draw.whole(0, 9) != 0;
    tick.seen.estop_b_closed = draw.whole(0, 9) != 0;
    tick.seen.log_backlog_ms = tick.seen.patient_motion_um = 0;
    tick.seen.tissue_residual_um = draw.whole(0, 700);
    tick.seen.plan_tag = tick.seen.config_tag = 1;
    tick.seen.confirmed_tag = {1, 1};
    tick.asked.now_us = tick.seen.now_us;
    tick.asked.self_test = safety::SelfTest::Passed;
    tick.asked.local_arm = draw.coin();
    tick.asked.local_reset = draw.coin();
    tick.asked.motion = {static_cast<std::uint32_t>(k / 3), draw.coin()};
    tick.permit = any_permit(draw, seq);
    tick.request = {.seq = seq, .wanted_mV = draw.whole(-9'000'000, 9'000'000)};
    tick.gate_us = static_cast<std::int64_t>(k) * 1'000;
    stream.ticks.push_back(tick);
  }
  return stream;
}

bool write_streams(const std::filesystem::path& file, const std::vector<Stream>& streams) {
  std::ofstream out(file, std::ios::binary);
  const auto put = [&](const void* bytes, std::size_t size) {
    out.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  };
  for (const Stream& stream : streams) {
    const std::uint64_t count = stream.ticks.size();
    put(&stream.facts, sizeof(stream.facts));
    put(&count, sizeof(count));
    put(stream.ticks.data(), count * sizeof(TickInput));
  }
  out.close();
  return static_cast<bool>(out);
}

std::vector<Stream> read_streams(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const auto get = [&](void* bytes, std::size_t size) {
    return static_cast<bool>(in.read(static_cast<char*>(bytes), static_cast<std::streamsize>(size)));
  };
  std::vector<Stream> streams;
  Stream stream;
  for (std::uint64_t count = 0; get(&stream.facts, sizeof(stream.facts)) && get(&count, sizeof(count));) {
    stream.ticks.resize(count);
    if (!get(stream.ticks.data(), count * sizeof(TickInput))) break;
    streams.push_back(stream);
  }
  return streams;
}

}  // namespace biopsy::fault_injection
