// The robot's bus over DDS (Cyclone DDS 0.10): a participant, and one writer or reader a topic. A message
// that arrives proves nothing but that it arrived: safety/ judges its age, order and contents.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

namespace biopsy::transport {

struct BusSettings {
  std::uint32_t domain = 0;
  std::string configuration;  // Cyclone's XML, security included; the environment is not read
  std::uint32_t robot = 1;    // messages with another robot's number are ignored
};

// Owns a handle of the C library.
class Entity {
 public:
  Entity() = default;
  // Throws ConfigError that names `what` where `handle` is an error code (< 0).
  Entity(std::int32_t handle, const char* what);
  Entity(Entity&& other) noexcept;
  Entity& operator=(Entity&& other) noexcept;
  ~Entity();
  std::int32_t handle() const { return handle_; }

 private:
  std::int32_t handle_ = 0;
};

// Messages of participants that failed authentication, since this process started.
std::uint32_t unauthenticated_messages();

class Participant {
 public:
  // Throws ConfigError where the configuration or the keys are not accepted. One per domain and process.
  explicit Participant(const BusSettings& settings);
  std::int32_t handle() const { return participant_.handle(); }
  std::uint32_t robot() const { return robot_; }

 private:
  Entity domain_, participant_;
  std::uint32_t robot_;
};

template <class Message>
class Writer {
 public:
  explicit Writer(const Participant& participant);

  // False: not sent. True says nothing about its arrival.
  bool write(const Message& message);
  int readers() const;  // matched now

 private:
  Entity topic_, writer_;
  std::uint32_t robot_;
};

template <class Message>
class Reader {
 public:
  explicit Reader(const Participant& participant);
  ~Reader();
  Reader(Reader&&) noexcept;

  // The oldest message not yet taken. Allocates nothing for messages of fixed size. What another writer wrote
  // while the one of the messages before was still there is dropped, unless each process writes this topic.
  bool take(Message& message);
  // The newest; older ones are dropped. Returns how many there were.
  int take_newest(Message& message);
  // Matched now; 2 at least where a message since the last call came from another writer than the messages
  // before, which was still there: one that came, wrote and went is not overlooked.
  int writers() const;
  int alive_writers() const;               // that wrote within their lease
  std::uint32_t missed_deadlines() const;  // since this reader was made
  std::int32_t handle() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

// Blocks until one of its readers has a message.
class WaitSet {
 public:
  explicit WaitSet(const Participant& participant);
  template <class Message>
  void add(const Reader<Message>& reader) {
    add(reader.handle());
  }
  // False: timeout.
  bool wait(std::chrono::nanoseconds timeout);

 private:
  void add(std::int32_t reader);
  Entity set_;
  std::array<Entity, 8> conditions_;
  std::size_t count_ = 0;
};

}  // namespace biopsy::transport
