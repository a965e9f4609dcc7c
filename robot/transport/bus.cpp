#include "robot/transport/bus.hpp"

#include <dds/dds.h>
#include <dds/ddsrt/log.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cstring>
#include <type_traits>
#include <utility>

#include "robot/common/config_error.hpp"
#include "robot/common/logging/logger.hpp"
#include "robot/msg/topics.hpp"
#include "robot/transport/codec.hpp"

namespace biopsy::transport {
namespace {

std::atomic<std::uint32_t> unauthenticated{0};

logging::Level level_of(std::uint32_t category) {
  if ((category & (DDS_LC_FATAL | DDS_LC_ERROR)) != 0) return logging::Level::Error;
  if ((category & DDS_LC_WARNING) != 0) return logging::Level::Warning;
  return (category & DDS_LC_INFO) != 0 ? logging::Level::Info : logging::Level::Debug;
}

void log_trace(void*, const dds_log_data_t* data) {
  logging::write(logging::Component::Dds, level_of(data->priority), {data->message, data->size});
}

// The library reports a failed authentication only in its log. "Remote secure participant not allowed" is
// none: it is logged of authenticated participants that called while this one was still being made.
void on_log_message(void*, const dds_log_data_t* data) {
  const std::string_view text(data->message, data->size);
  const auto contains = [text](std::string_view part) { return text.find(part) != std::string_view::npos; };
  if (contains("Remote secure participant") && contains("not allowed")) return;
  if (contains("Non secure remote participant") || contains("fsm") || contains("ecurity"))
    unauthenticated.fetch_add(1, std::memory_order_relaxed);
  logging::write(logging::Component::Dds, level_of(data->priority), text);
}

struct QosFree {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosFree>;

dds_duration_t or_infinite(std::chrono::milliseconds time) {
  return time.count() > 0 ? std::chrono::nanoseconds(time).count() : DDS_INFINITY;
}

Qos qos_of(const Topic& topic) {
  Qos qos(dds_create_qos());
  // Blocking time 0: a writer never waits for a slow reader.
  dds_qset_reliability(qos.get(), topic.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, 0);
  dds_qset_durability(qos.get(),
                      topic.transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, topic.depth);
  dds_qset_deadline(qos.get(), or_infinite(topic.deadline));
  dds_qset_liveliness(qos.get(), DDS_LIVELINESS_MANUAL_BY_TOPIC, or_infinite(topic.lease));
  dds_qset_writer_data_lifecycle(qos.get(), false);  // instances outlive their writer
  return qos;
}

template <class Message>
Entity topic_on(const Participant& participant) {
  const std::string name(kTopic<Message>.name);
  return {dds_create_topic(participant.handle(), &WireType<Message>::descriptor(), name.c_str(), nullptr,
                           nullptr),
          name.c_str()};
}

// Of all other topics one process is the writer.
template <class Message>
constexpr bool kEachProcessWrites = std::is_same_v<Message, Health>;

// Whether the reader still knows this writer; asked only where another one wrote.
bool is_matched(dds_entity_t reader, dds_instance_handle_t writer) {
  std::array<dds_instance_handle_t, 16> writers{};
  const auto known = dds_get_matched_publications(reader, writers.data(), writers.size());
  const auto end = writers.begin() + std::clamp<std::ptrdiff_t>(known, 0, std::ssize(writers));
  return writer != 0 && std::find(writers.begin(), end, writer) != end;
}

}  // namespace

Entity::Entity(std::int32_t handle, const char* what) : handle_(handle) {
  if (handle < 0)
    throw ConfigError(fmt::format("the bus refused: {} ({})", what, dds_strretcode(handle)), "DDS",
                      "see the lines before this one; check keys, permissions and the network interface");
}
Entity::Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
Entity& Entity::operator=(Entity&& other) noexcept {
  std::swap(handle_, other.handle_);
  return *this;
}
Entity::~Entity() {
  if (handle_ > 0) dds_delete(handle_);
}

std::uint32_t unauthenticated_messages() {
  return unauthenticated.load(std::memory_order_relaxed);
}

Participant::Participant(const BusSettings& settings) : robot_(settings.robot) {
  dds_set_log_sink(on_log_message, nullptr);
  dds_set_trace_sink(log_trace, nullptr);
  domain_ = Entity(dds_create_domain(settings.domain, settings.configuration.c_str()), "domain");
  participant_ = Entity(dds_create_participant(settings.domain, nullptr, nullptr), "participant");
}

template <class Message>
Writer<Message>::Writer(const Participant& participant)
    : topic_(topic_on<Message>(participant)),
      writer_(
          dds_create_writer(participant.handle(), topic_.handle(), qos_of(kTopic<Message>).get(), nullptr),
          "writer"),
      robot_(participant.robot()) {}

template <class Message>
bool Writer<Message>::write(const Message& message) {
  typename WireType<Message>::Type wire{};
  wire.robot = robot_;
  encode(message, wire);
  return dds_write(writer_.handle(), &wire) == DDS_RETCODE_OK;
}

template <class Message>
int Writer<Message>::readers() const {
  dds_publication_matched_status_t status{};
  dds_get_publication_matched_status(writer_.handle(), &status);
  return static_cast<int>(status.current_count);
}

template <class Message>
struct Reader<Message>::Parts {
  Entity topic, reader;
  std::uint32_t robot;
  typename WireType<Message>::Type wire{};  // the library fills it and keeps what it allocated for lists
  dds_instance_handle_t writer = 0;         // of the messages so far
  bool second_wrote = false;                // while that one was there; since the count was last asked for

  ~Parts() { dds_sample_free(&wire, &WireType<Message>::descriptor(), DDS_FREE_CONTENTS); }
};

template <class Message>
Reader<Message>::Reader(const Participant& participant) {
  const Qos qos = qos_of(kTopic<Message>);
  Entity topic = topic_on<Message>(participant);
  const std::int32_t reader = dds_create_reader(participant.handle(), topic.handle(), qos.get(), nullptr);
  parts_.reset(new Parts{std::move(topic), Entity(reader, "reader"), participant.robot()});
}
template <class Message>
Reader<Message>::~Reader() = default;
template <class Message>
Reader<Message>::Reader(Reader&&) noexcept = default;

template <class Message>
bool Reader<Message>::take(Message& message) {
  for (;;) {
    void* sample = &parts_->wire;
    dds_sample_info_t info{};
    if (dds_take(parts_->reader.handle(), &sample, &info, 1, 1) <= 0) return false;
    if (!info.valid_data || parts_->wire.robot != parts_->robot) continue;
    if (info.publication_handle != parts_->writer) {
      const bool second = is_matched(parts_->reader.handle(), parts_->writer);
      parts_->second_wrote = parts_->second_wrote || second;
      if (second && !kEachProcessWrites<Message>) continue;
      parts_->writer = info.publication_handle;
    }
    decode(parts_->wire, message);
    return true;
  }
}

template <class Message>
int Reader<Message>::take_newest(Message& message) {
  int count = 0;
  while (take(message)) ++count;
  return count;
}

template <class Message>
int Reader<Message>::writers() const {
  dds_subscription_matched_status_t status{};
  dds_get_subscription_matched_status(parts_->reader.handle(), &status);
  const bool second_wrote = std::exchange(parts_->second_wrote, false);
  return std::max(static_cast<int>(status.current_count), second_wrote ? 2 : 0);
}

template <class Message>
int Reader<Message>::alive_writers() const {
  dds_liveliness_changed_status_t status{};
  dds_get_liveliness_changed_status(parts_->reader.handle(), &status);
  return static_cast<int>(status.alive_count);
}

template <class Message>
std::uint32_t Reader<Message>::missed_deadlines() const {
  dds_requested_deadline_missed_status_t status{};
  dds_get_requested_deadline_missed_status(parts_->reader.handle(), &status);
  return status.total_count;
}

template <class Message>
std::int32_t Reader<Message>::handle() const {
  return parts_->reader.handle();
}

WaitSet::WaitSet(const Participant& participant)
    : set_(dds_create_waitset(participant.handle()), "waitset") {}

void WaitSet::add(std::int32_t reader) {
  assert(count_ < conditions_.size());
  Entity& condition = conditions_[count_++];
  condition = Entity(dds_create_readcondition(reader, DDS_ANY_STATE), "read condition");
  dds_waitset_attach(set_.handle(), condition.handle(), 0);
}

bool WaitSet::wait(std::chrono::nanoseconds timeout) {
  return dds_waitset_wait(set_.handle(), nullptr, 0, timeout.count()) > 0;
}

#define BIOPSY_INSTANTIATE(Message) \
  template class Writer<Message>;   \
  template class Reader<Message>;
BIOPSY_FOR_EACH_MESSAGE(BIOPSY_INSTANTIATE)
#undef BIOPSY_INSTANTIATE

}  // namespace biopsy::transport
