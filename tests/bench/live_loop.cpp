#include "tests/bench/live_loop.hpp"

#include <dds/dds.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <wire.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <string>
#include <vector>

#include "robot/live/controller_loop.hpp"
#include "robot/live/realtime/become_realtime.hpp"
#include "robot/live/realtime/latency_histogram.hpp"
#include "robot/live/realtime/tick_clock.hpp"
#include "robot/security/cyclone_xml.hpp"
#include "robot/security/make_keys.hpp"
#include "robot/transport/bus.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::bench {
namespace {

using namespace std::chrono_literals;

constexpr int kRounds = 12;
constexpr std::uint32_t kTrips = 3'000, kWarmUp = 1'000;

std::string configuration(const std::filesystem::path& keys, security::Role role) {
  security::CycloneOptions options;
  if (!keys.empty()) options.security = security::Security{keys, role};
  return security::cyclone_xml(options);
}

void take_precedence() {
  realtime::become_realtime(
      {.lock_memory = false, .fifo_priority = 60, .threads_inherit = true, .cpu = std::nullopt});
}

// A child that runs `body` until it is killed.
template <class Body>
pid_t child(const Body& body) {
  const pid_t pid = fork();
  if (pid != 0) return pid;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  take_precedence();
  body();
  _exit(0);
}

// The shipped controller, without a plan: alive, and asks for nothing.
void answer_as_controller(std::uint32_t domain, const std::string& xml) {
  const transport::Participant bus({domain, xml, 1});
  live::ControllerLoop loop(bus, 1);
  for (;;) loop.turn(10ms);
}

// One end of the C library alone: a reader of one topic, a writer of the other, with the robot's QoS.
struct Bare {
  dds_entity_t reader = 0, writer = 0, set = 0;
};

Bare bare_end(std::uint32_t domain, const std::string& xml, bool stage) {
  dds_create_domain(domain, xml.c_str());
  const dds_entity_t participant = dds_create_participant(domain, nullptr, nullptr);
  const dds_entity_t measurement =
      dds_create_topic(participant, &biopsy_wire_Measurement_desc, "Measurement", nullptr, nullptr);
  const dds_entity_t request =
      dds_create_topic(participant, &biopsy_wire_DriveRequest_desc, "DriveRequest", nullptr, nullptr);
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
  dds_qset_liveliness(qos, DDS_LIVELINESS_MANUAL_BY_TOPIC, DDS_MSECS(20));
  dds_qset_deadline(qos, DDS_MSECS(10));
  Bare end;
  end.reader = dds_create_reader(participant, stage ? request : measurement, qos, nullptr);
  end.writer = dds_create_writer(participant, stage ? measurement : request, qos, nullptr);
  end.set = dds_create_waitset(participant);
  dds_waitset_attach(end.set, dds_create_readcondition(end.reader, DDS_ANY_STATE), 0);
  dds_delete_qos(qos);
  return end;
}

// Takes a measurement, sends a request.
void answer_bare(std::uint32_t domain, const std::string& xml) {
  const Bare end = bare_end(domain, xml, false);
  biopsy_wire_Measurement measured{};
  biopsy_wire_DriveRequest request{};
  request.robot = 1;
  for (;;) {
    dds_waitset_wait(end.set, nullptr, 0, DDS_MSECS(10));
    void* sample = &measured;
    dds_sample_info_t info{};
    while (dds_take(end.reader, &sample, &info, 1, 1) > 0) {
      request.seq = request.measured_seq = measured.seq;
      dds_write(end.writer, &request);
    }
  }
}

// Sends at 1 kHz and has each answer awaited. us
template <class Send, class Await>
void measure(realtime::LatencyHistogram& trips, const Send& send, const Await& await) {
  realtime::TickClock clock(1ms);
  for (std::uint32_t seq = 1; seq <= kWarmUp + kTrips; ++seq) {
    clock.wait();
    const std::int64_t sent_ns = realtime::monotonic_ns();
    send(seq);
    if (await(seq) && seq > kWarmUp) trips.record(realtime::monotonic_ns() - sent_ns);
  }
}

void measure_bare(std::uint32_t domain, const std::string& xml, realtime::LatencyHistogram& trips) {
  const Bare end = bare_end(domain, xml, true);
  dds_subscription_matched_status_t from{};
  dds_publication_matched_status_t to{};
  while (from.current_count == 0 || to.current_count == 0) {
    usleep(1000);
    dds_get_subscription_matched_status(end.reader, &from);
    dds_get_publication_matched_status(end.writer, &to);
  }
  biopsy_wire_Measurement measured{};
  measured.robot = 1;
  biopsy_wire_DriveRequest request{};
  const auto send = [&](std::uint32_t seq) {
    measured.seq = seq;
    dds_write(end.writer, &measured);
  };
  const auto await = [&](std::uint32_t seq) {
    while (dds_waitset_wait(end.set, nullptr, 0, DDS_MSECS(20)) > 0) {
      void* sample = &request;
      dds_sample_info_t info{};
      while (dds_take(end.reader, &sample, &info, 1, 1) > 0)
        if (request.measured_seq == seq) return true;
    }
    return false;
  };
  measure(trips, send, await);
}

void measure_ours(std::uint32_t domain, const std::string& xml, realtime::LatencyHistogram& trips) {
  const transport::Participant bus({domain, xml, 1});
  transport::Writer<Measurement> measurements(bus);
  transport::Reader<DriveRequest> requests(bus);
  transport::WaitSet wait_set(bus);
  wait_set.add(requests);
  while (measurements.readers() == 0 || requests.writers() == 0) usleep(1000);
  Measurement m;
  const auto send = [&](std::uint32_t seq) {
    m.seq = seq;
    measurements.write(m);
  };
  const auto await = [&](std::uint32_t seq) {
    DriveRequest request;
    while (wait_set.wait(20ms))
      while (requests.take(request))
        if (request.measured_seq == seq) return true;
    return false;
  };
  measure(trips, send, await);
}

// Both sides in processes of their own, since a process joins a domain once. The figures come by a pipe.
struct Figures {
  std::int64_t p50_us, p99_us, max_us;
};

template <class Answer, class Measure>
Figures round_trip(std::uint32_t domain, const std::filesystem::path& keys, const Answer& answer,
                   const Measure& measured_by) {
  int ends[2];
  if (pipe(ends) != 0) return {};
  const pid_t other = child([&] { answer(domain, configuration(keys, security::Role::Controller)); });
  const pid_t self = child([&] {
    realtime::LatencyHistogram trips;
    measured_by(domain, configuration(keys, security::Role::Stage), trips);
    const Figures figures{trips.p50_us(), trips.p99_us(), trips.max_us()};
    [[maybe_unused]] const ssize_t written = write(ends[1], &figures, sizeof figures);
  });
  Figures figures{};
  waitpid(self, nullptr, 0);
  [[maybe_unused]] const ssize_t got = read(ends[0], &figures, sizeof figures);
  kill(other, SIGKILL);
  waitpid(other, nullptr, 0);
  close(ends[0]);
  close(ends[1]);
  return figures;
}

double middle(std::vector<double> values, double share = 0.5) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

// Rounds of both, each with new processes: where the scheduler puts them weighs more than the code, and a
// machine's pace wanders. So the two take turns, and what counts is the middle round.
class Rounds {
 public:
  void add(const Figures& one) {
    p50_.push_back(static_cast<double>(one.p50_us));
    p99_.push_back(static_cast<double>(one.p99_us));
    max_us_ = std::max(max_us_, one.max_us);
  }
  double p50(std::size_t round) const { return p50_[round]; }
  std::string text() const {
    return fmt::format("{:>10.0f}{:>8.0f}{:>8}", middle(p50_), middle(p99_), max_us_);
  }
  double p50() const { return middle(p50_); }

 private:
  std::vector<double> p50_, p99_;
  std::int64_t max_us_ = 0;
};

}  // namespace

void bench_loop(const robot::LiveOptions& options) {
  const ScratchFolder folder;
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  security::make_keys(folder.path() / "keys", 1, now, false);
  fmt::print(
      "Measurement published to DriveRequest received, us ({} rounds of {} round trips at 1 kHz, by turns)\n",
      kRounds, kTrips);
  fmt::print("{:<12}{:>10}{:>8}{:>8}{:>10}{:>8}{:>8}{:>8}{:>24}\n", "", "bare p50", "p99", "max", "ours p50",
             "p99", "max", "ratio", "a round's, 10 to 90 %");
  for (const bool secured : {false, true}) {
    const std::filesystem::path keys = secured ? folder.path() / "keys" : std::filesystem::path();
    Rounds bare, ours;
    std::vector<double> ratios;
    for (std::size_t round = 0; round < kRounds; ++round) {
      const bool bare_first = round % 2 == 0;
      if (bare_first) bare.add(round_trip(options.domain + 1, keys, answer_bare, measure_bare));
      ours.add(round_trip(options.domain + 2, keys, answer_as_controller, measure_ours));
      if (!bare_first) bare.add(round_trip(options.domain + 1, keys, answer_bare, measure_bare));
      ratios.push_back(ours.p50(round) / std::max(bare.p50(round), 1.0));
    }
    fmt::print("{:<12}{}{}{:>8.2f}{:>16.2f} to {:.2f}\n", secured ? "secured" : "plain", bare.text(),
               ours.text(), ours.p50() / std::max(bare.p50(), 1.0), middle(ratios, 0.1), middle(ratios, 0.9));
    std::fflush(stdout);
  }
}

}  // namespace biopsy::bench
