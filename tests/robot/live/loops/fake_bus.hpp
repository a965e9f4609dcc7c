// The bus and the clock of the live loops in a test: robot/transport/bus.hpp and monotonic_ns(), linked in
// place of DDS and of the machine's clock. One process, no network, virtual time; a loop is compiled as it
// ships.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

#include "robot/msg/messages.hpp"
#include "robot/transport/bus.hpp"

namespace biopsy::fake_bus {

// One topic.
template <class Message>
struct Channel {
  std::vector<std::deque<Message>*> readers;
  std::vector<Message> written;  // by the loops, in order
  int writers = 1, alive = 1;    // as a reader finds them
  std::uint32_t missed = 0;      // deadlines
};

struct State {
  std::recursive_mutex mutex;
  std::vector<std::function<bool()>> has_message;  // by a reader's handle
  // What a wait without a message does; unless given, it lasts its time.
  std::function<void(std::chrono::nanoseconds)> on_wait;
  std::function<void()> on_clock;                // before the clock is read
  std::vector<std::chrono::nanoseconds> waited;  // timeouts that were asked for
  std::size_t watched = 0;                       // readers that the last wait waited for
  std::int64_t now_ns = 0;
  std::uint32_t unauthenticated = 0;
  int endpoints = 0, participants = 0;                    // that the monitor of a secured bus finds
  std::vector<transport::BusSettings> joined, monitored;  // by participants, and by such monitors
};
State& state();

template <class Message>
Channel<Message>& channel() {
  static Channel<Message> one;
  return one;
}

// Delivers what another process wrote.
template <class Message>
void put(const Message& message);

// What the loops wrote since the last call.
template <class Message>
std::vector<Message> written() {
  const std::scoped_lock lock(state().mutex);
  return std::exchange(channel<Message>().written, {});
}

// One writer of each topic, alive; nothing written; the clock at `now_us`.
void reset(std::int64_t now_us);
// Reading the clock takes 10 ns.
void set_clock_us(std::int64_t now_us);

}  // namespace biopsy::fake_bus
