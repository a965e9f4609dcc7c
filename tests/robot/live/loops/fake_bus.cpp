#include "tests/robot/live/loops/fake_bus.hpp"

#include "robot/live/realtime/tick_clock.hpp"
#include "robot/msg/topics.hpp"
#include "robot/transport/bus.hpp"
#include "robot/transport/participant_monitor.hpp"

namespace biopsy::fake_bus {

State& state() {
  static State one;
  return one;
}

template <class Message>
void put(const Message& message) {
  const std::scoped_lock lock(state().mutex);
  for (std::deque<Message>* queue : channel<Message>().readers) {
    queue->push_back(message);
    if (queue->size() > static_cast<std::size_t>(kTopic<Message>.depth)) queue->pop_front();
  }
}

template <class Message>
void reset_channel() {
  Channel<Message>& all = channel<Message>();
  all.written.clear();
  all.writers = all.alive = 1;
  all.missed = 0;
  for (std::deque<Message>* queue : all.readers) queue->clear();
}

void set_clock_us(std::int64_t now_us) {
  const std::scoped_lock lock(state().mutex);
  state().now_ns = now_us * 1'000;
}

void reset(std::int64_t now_us) {
  const std::scoped_lock lock(state().mutex);
  state().on_wait = nullptr;
  state().on_clock = nullptr;
  state().waited.clear();
  state().unauthenticated = 0;
  state().endpoints = state().participants = 0;
  state().joined.clear();
  state().monitored.clear();
  set_clock_us(now_us);
#define BIOPSY_RESET(Message) reset_channel<Message>();
  BIOPSY_FOR_EACH_MESSAGE(BIOPSY_RESET)
#undef BIOPSY_RESET
}

#define BIOPSY_PUT(Message) template void put<Message>(const Message&);
BIOPSY_FOR_EACH_MESSAGE(BIOPSY_PUT)
#undef BIOPSY_PUT

}  // namespace biopsy::fake_bus

namespace biopsy::realtime {

std::int64_t monotonic_ns() {
  const std::scoped_lock lock(fake_bus::state().mutex);
  if (fake_bus::state().on_clock) fake_bus::state().on_clock();
  return fake_bus::state().now_ns += 10;
}

}  // namespace biopsy::realtime

namespace biopsy::transport {

Entity::Entity(std::int32_t handle, const char*) : handle_(handle) {}
Entity::Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
Entity& Entity::operator=(Entity&& other) noexcept {
  std::swap(handle_, other.handle_);
  return *this;
}
Entity::~Entity() = default;

std::uint32_t unauthenticated_messages() {
  return fake_bus::state().unauthenticated;
}

Participant::Participant(const BusSettings& settings) : robot_(settings.robot) {
  fake_bus::state().joined.push_back(settings);
}

ParticipantMonitor::ParticipantMonitor(const BusSettings& plain, const Participant&) {
  fake_bus::state().monitored.push_back(plain);
}
int ParticipantMonitor::unauthenticated_endpoints() const {
  return fake_bus::state().endpoints;
}
int ParticipantMonitor::unauthenticated_participants() const {
  return fake_bus::state().participants;
}

template <class Message>
Writer<Message>::Writer(const Participant& participant) : robot_(participant.robot()) {}
template <class Message>
bool Writer<Message>::write(const Message& message) {
  const std::scoped_lock lock(fake_bus::state().mutex);
  fake_bus::channel<Message>().written.push_back(message);
  fake_bus::put(message);
  return true;
}
template <class Message>
int Writer<Message>::readers() const {
  return static_cast<int>(fake_bus::channel<Message>().readers.size());
}

template <class Message>
struct Reader<Message>::Parts {
  std::deque<Message> queue;
  std::int32_t handle = 0;

  Parts() {
    const std::scoped_lock lock(fake_bus::state().mutex);
    fake_bus::channel<Message>().readers.push_back(&queue);
    fake_bus::state().has_message.emplace_back([this] { return !queue.empty(); });
    handle = static_cast<std::int32_t>(fake_bus::state().has_message.size()) - 1;
  }
  ~Parts() {
    const std::scoped_lock lock(fake_bus::state().mutex);
    std::erase(fake_bus::channel<Message>().readers, &queue);
    fake_bus::state().has_message[static_cast<std::size_t>(handle)] = [] { return false; };
  }
};

template <class Message>
Reader<Message>::Reader(const Participant&) : parts_(new Parts) {}
template <class Message>
Reader<Message>::~Reader() = default;
template <class Message>
Reader<Message>::Reader(Reader&&) noexcept = default;
template <class Message>
bool Reader<Message>::take(Message& message) {
  const std::scoped_lock lock(fake_bus::state().mutex);
  if (parts_->queue.empty()) return false;
  message = std::move(parts_->queue.front());
  parts_->queue.pop_front();
  return true;
}
template <class Message>
int Reader<Message>::take_newest(Message& message) {
  int count = 0;
  while (take(message)) ++count;
  return count;
}
template <class Message>
int Reader<Message>::writers() const {
  return fake_bus::channel<Message>().writers;
}
template <class Message>
int Reader<Message>::alive_writers() const {
  return fake_bus::channel<Message>().alive;
}
template <class Message>
std::uint32_t Reader<Message>::missed_deadlines() const {
  return fake_bus::channel<Message>().missed;
}
template <class Message>
std::int32_t Reader<Message>::handle() const {
  return parts_->handle;
}

WaitSet::WaitSet(const Participant&) {}
void WaitSet::add(std::int32_t reader) {
  conditions_[count_++] = Entity(reader, "reader");
}
bool WaitSet::wait(std::chrono::nanoseconds timeout) {
  std::function<void(std::chrono::nanoseconds)> on_wait;
  {
    const std::scoped_lock lock(fake_bus::state().mutex);
    fake_bus::State& bus = fake_bus::state();
    bus.waited.push_back(timeout);
    bus.watched = count_;
    on_wait = bus.on_wait;
    if (!on_wait) {
      for (std::size_t i = 0; i < count_; ++i)
        if (bus.has_message[static_cast<std::size_t>(conditions_[i].handle())]()) return true;
      bus.now_ns += timeout.count();
      return false;
    }
  }
  on_wait(timeout);
  return true;
}

#define BIOPSY_INSTANTIATE(Message) \
  template class Writer<Message>;   \
  template class Reader<Message>;
BIOPSY_FOR_EACH_MESSAGE(BIOPSY_INSTANTIATE)
#undef BIOPSY_INSTANTIATE

}  // namespace biopsy::transport
