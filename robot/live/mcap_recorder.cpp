#include "robot/live/mcap_recorder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <tuple>

#include "robot/common/config_error.hpp"
#include "robot/msg/json_messages.hpp"
#include "robot/recorder/mcap_writer.hpp"

namespace biopsy::robot {
namespace {

constexpr std::int64_t kFlushEvery_us = 1'000'000;
constexpr const char* kFull =
    "make room on the disk; the robot and its procedure log go on without this file";

// Whether more than numbers and clocks differs: such a message of a cyclic topic is never left out.
template <class Message>
bool changed(const Message&, const Message&) {
  return false;
}
bool changed(const Measurement& a, const Measurement& b) {
  return a.verdict != b.verdict || a.hv_enabled != b.hv_enabled || a.brake_on != b.brake_on ||
         a.laser_valid != b.laser_valid || a.laser_b_valid != b.laser_b_valid;
}
bool changed(const DriveRequest& a, const DriveRequest& b) {
  return a.step != b.step || a.step_reached != b.step_reached || a.finished != b.finished ||
         a.brake != b.brake;
}
bool changed(const Permit& a, const Permit& b) {
  return a.session != b.session || a.epoch != b.epoch || a.mode != b.mode || a.stop != b.stop ||
         a.hv_enable != b.hv_enable;
}
bool changed(const Decision& a, const Decision& b) {
  return a.session != b.session || a.mode != b.mode || a.stop != b.stop || a.event != b.event ||
         a.worst != b.worst || a.reason != b.reason || a.refusal != b.refusal || a.step != b.step ||
         a.step_done != b.step_done || a.panel_unread_ms != b.panel_unread_ms;
}

// Sent every tick.
template <class Message>
constexpr bool kCyclic = !kTopic<Message>.reliable || std::is_same_v<Message, Decision>;

template <class Message>
struct Recorded {
  explicit Recorded(const transport::Participant& bus) : reader(bus) {}
  transport::Reader<Message> reader;
  Message last{};
  std::uint16_t channel = 0;
  std::uint32_t count = 0;  // of messages that arrived
  std::int64_t due_us = 0;
};

template <class Tuple>
struct RecordedOf;
template <class... Message>
struct RecordedOf<std::tuple<Message...>> {
  using Type = std::tuple<Recorded<Message>...>;
};

// Owner and group may read: plans and operators are named in it.
int make_file(const std::filesystem::path& file) {
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0640);
  if (descriptor < 0)
    throw ConfigError(fmt::format("cannot be made: {}", std::strerror(errno)), file.string(),
                      "choose a folder that this user may write");
  return descriptor;
}

}  // namespace

struct McapRecorder::Parts {
  Parts(const transport::Participant& bus, const std::filesystem::path& name, double rate_Hz,
        const std::string& library)
      : file(name.string()),
        descriptor(make_file(name)),
        period_us(static_cast<std::int64_t>(1e6 / rate_Hz)),
        writer(library),
        topics(each<Messages>(bus)) {
    std::apply([&](auto&... topic) { (declare(topic), ...); }, topics);
  }
  ~Parts() { close(descriptor); }

  template <class Tuple>
  static typename RecordedOf<Tuple>::Type each(const transport::Participant& bus) {
    return each_of(bus, static_cast<Tuple*>(nullptr));
  }
  template <class... Message>
  static std::tuple<Recorded<Message>...> each_of(const transport::Participant& bus,
                                                  std::tuple<Message...>*) {
    return {Recorded<Message>(bus)...};
  }

  template <class Message>
  void declare(Recorded<Message>& topic) {
    const std::string name(kTopic<Message>.name);
    topic.channel = writer.add_channel("/" + name, "biopsy." + name, kJsonSchema<Message>);
  }

  template <class Message>
  void take(Recorded<Message>& topic, std::int64_t now_us, std::int64_t utc_ns) {
    Message next;
    while (topic.reader.take(next)) {
      ++topic.count;
      if (!kCyclic<Message> || now_us >= topic.due_us || changed(next, topic.last)) {
        writer.add_message(
            topic.channel, topic.count, static_cast<std::uint64_t>(utc_ns),
            json_of(next).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
        topic.due_us = now_us + period_us;
      }
      topic.last = next;
    }
  }

  void write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0)
        throw ConfigError(fmt::format("cannot be written: {}", std::strerror(errno)), file, kFull);
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    if (fdatasync(descriptor) != 0)
      throw ConfigError(fmt::format("cannot be written: {}", std::strerror(errno)), file, kFull);
  }

  std::string file;
  int descriptor;
  std::int64_t period_us, flush_us = 0;
  recorder::McapWriter writer;
  RecordedOf<Messages>::Type topics;
};

McapRecorder::McapRecorder(const transport::Participant& bus, const std::filesystem::path& file,
                           double rate_Hz, const std::string& library)
    : parts_(std::make_unique<Parts>(bus, file, rate_Hz, library)) {}

McapRecorder::~McapRecorder() = default;

void McapRecorder::turn(std::int64_t now_us, std::int64_t utc_ns) {
  std::apply([&](auto&... topic) { (parts_->take(topic, now_us, utc_ns), ...); }, parts_->topics);
  if (now_us < parts_->flush_us) return;
  parts_->flush_us = now_us + kFlushEvery_us;
  parts_->write(parts_->writer.take());
}

void McapRecorder::finish() {
  parts_->write(parts_->writer.finish());
}

std::filesystem::path free_mcap_name(const std::filesystem::path& folder) {
  std::filesystem::path file = folder / "bus.mcap";
  for (int n = 2; std::filesystem::exists(file); ++n) file = folder / fmt::format("bus-{}.mcap", n);
  return file;
}

}  // namespace biopsy::robot
