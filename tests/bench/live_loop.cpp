#include "tests/bench/live_loop.hpp"

#include <biopsy.h>
#include <dds/dds.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <string>

#include "robot/keys/cyclone_xml.hpp"
#include "robot/keys/make_keys.hpp"
#include "robot/live/controller_loop.hpp"
#include "robot/realtime/become_realtime.hpp"
#include "robot/realtime/latency_histogram.hpp"
#include "robot/realtime/tick_clock.hpp"
#include "robot/transport/bus.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::bench {
namespace {

using namespace std::chrono_literals;

constexpr int kTrips = 10'000, kWarmUp = 2'000;

std::string configuration(const std::filesystem::path& keys, keys::Role role) {
  keys::CycloneOptions options;
  if (!keys.empty()) options.security = keys::Security{keys, role};
  return keys::cyclone_xml(options);
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

// The C library alone: takes a measurement, sends a request.
void answer_bare(std::uint32_t domain, const std::string& xml) {
  dds_create_domain(domain, xml.c_str());
  const dds_entity_t participant = dds_create_participant(domain, nullptr, nullptr);
  const auto topic = [&](const dds_topic_descriptor_t& descriptor, const char* name) {
    return dds_create_topic(participant, &descriptor, name, nullptr, nullptr);
  };
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
  const dds_entity_t reader =
      dds_create_reader(participant, topic(biopsy_wire_Measurement_desc, "Measurement"), qos, nullptr);
  dds_qset_liveliness(qos, DDS_LIVELINESS_MANUAL_BY_TOPIC, DDS_MSECS(20));
  dds_qset_deadline(qos, DDS_MSECS(10));
  const dds_entity_t writer =
      dds_create_writer(participant, topic(biopsy_wire_DriveRequest_desc, "DriveRequest"), qos, nullptr);
  const dds_entity_t set = dds_create_waitset(participant);
  dds_waitset_attach(set, dds_create_readcondition(reader, DDS_ANY_STATE), 0);
  biopsy_wire_Measurement measured{};
  biopsy_wire_DriveRequest request{};
  request.robot = 1;
  for (;;) {
    dds_waitset_wait(set, nullptr, 0, DDS_MSECS(10));
    void* sample = &measured;
    dds_sample_info_t info{};
    while (dds_take(reader, &sample, &info, 1, 1) > 0) {
      request.seq = request.measured_seq = measured.seq;
      dds_write(writer, &request);
    }
  }
}

// Publishes at 1 kHz and waits for each answer.
void measure(std::uint32_t domain, const std::string& xml, realtime::LatencyHistogram& trips) {
  take_precedence();
  const transport::Participant bus({domain, xml, 1});
  transport::Writer<Measurement> measurements(bus);
  transport::Reader<DriveRequest> requests(bus);
  transport::Waker waker(bus);
  waker.add(requests);
  while (measurements.readers() == 0 || requests.writers() == 0) usleep(1000);
  realtime::TickClock clock(1ms);
  Measurement m;
  for (int n = 0; n < kWarmUp + kTrips; ++n) {
    clock.wait();
    ++m.seq;
    const std::int64_t sent_ns = realtime::monotonic_ns();
    measurements.write(m);
    DriveRequest request;
    bool back = false;
    while (!back && waker.wait(20ms))
      while (requests.take(request)) back = back || request.measured_seq == m.seq;
    if (back && n >= kWarmUp) trips.record(realtime::monotonic_ns() - sent_ns);
  }
}

// Both sides in processes of their own, since a process joins a domain once. The figures come by a pipe.
struct Figures {
  std::int64_t p50_us, p99_us, max_us;
};

template <class Answer>
Figures round_trip(std::uint32_t domain, const std::filesystem::path& keys, const Answer& answer) {
  int ends[2];
  if (pipe(ends) != 0) return {};
  const pid_t other = child([&] { answer(domain, configuration(keys, keys::Role::Controller)); });
  const pid_t self = child([&] {
    realtime::LatencyHistogram trips;
    measure(domain, configuration(keys, keys::Role::Stage), trips);
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

}  // namespace

void bench_loop(const app::LiveOptions& options) {
  const ScratchFolder folder;
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  keys::make_keys(folder.path() / "keys", 1, now, false);
  fmt::print("Measurement published to DriveRequest received, us ({} round trips at 1 kHz)\n", kTrips);
  fmt::print("{:<12}{:>10}{:>8}{:>8}{:>10}{:>8}{:>8}{:>9}\n", "", "bare p50", "p99", "max", "ours p50", "p99",
             "max", "p50 ratio");
  for (const bool secured : {false, true}) {
    const std::filesystem::path keys = secured ? folder.path() / "keys" : std::filesystem::path();
    const Figures bare = round_trip(options.domain + 1, keys, answer_bare);
    const Figures ours = round_trip(options.domain + 2, keys, answer_as_controller);
    fmt::print(
        "{:<12}{:>10}{:>8}{:>8}{:>10}{:>8}{:>8}{:>9.2f}\n", secured ? "secured" : "plain", bare.p50_us,
        bare.p99_us, bare.max_us, ours.p50_us, ours.p99_us, ours.max_us,
        static_cast<double>(ours.p50_us) / static_cast<double>(std::max<std::int64_t>(bare.p50_us, 1)));
    std::fflush(stdout);
  }
}

}  // namespace biopsy::bench
