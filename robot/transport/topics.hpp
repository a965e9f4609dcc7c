// Every topic: its name, and how it is delivered. The only place where a quality of service is written.
//
// What is cyclic (1 kHz) is best effort: only the newest counts, and a lost sample that is sent again would
// hold up the ones behind it. What must not be lost is reliable; what a late joiner must know stays with its
// writer (transient local). A writer is alive while it writes (MANUAL_BY_TOPIC): one that stands still,
// whatever its threads do, counts as none to the supervisor, and the log says when that was. Numbers in the
// messages are quicker; this is a second witness.
#pragma once

#include <chrono>
#include <cstdint>
#include <string_view>

#include "robot/msg/drive_request.hpp"
#include "robot/msg/live.hpp"
#include "robot/msg/measurement.hpp"
#include "robot/msg/permit.hpp"

namespace biopsy::transport {

struct Delivery {
  std::string_view topic;
  bool reliable = false;
  bool kept_for_late_joiners = false;
  std::int32_t depth = 1;              // samples that a reader keeps
  std::chrono::milliseconds alive{0};  // liveliness lease; 0: may be silent for ever
  std::chrono::milliseconds every{0};  // deadline; 0: none
};

template <class Message>
inline constexpr Delivery kDelivery{};

using std::chrono::milliseconds;

// The control loop: 16 samples bridge the stalls of a host that is not a real-time one.
template <>
inline constexpr Delivery kDelivery<Measurement>{"Measurement",    false,           false, 16,
                                                 milliseconds(20), milliseconds(10)};
template <>
inline constexpr Delivery kDelivery<DriveRequest>{"DriveRequest",   false,           false, 16,
                                                  milliseconds(20), milliseconds(10)};
template <>
inline constexpr Delivery kDelivery<Permit>{"Permit", false, false, 16, milliseconds(20), milliseconds(10)};
// A second of decisions: the log misses none while its disk is busy.
template <>
inline constexpr Delivery kDelivery<Decision>{"Decision",      true, false, 1024, milliseconds(20),
                                              milliseconds(10)};
template <>
inline constexpr Delivery kDelivery<StageTruth>{"StageTruth", false,           false,
                                                64,           milliseconds(0), milliseconds(0)};
template <>
inline constexpr Delivery kDelivery<OperatorAct>{"OperatorAct",    true, false, 16, milliseconds(200),
                                                 milliseconds(100)};
template <>
inline constexpr Delivery kDelivery<SealedPlan>{"SealedPlan",    true,           true, 1,
                                                milliseconds(0), milliseconds(0)};
template <>
inline constexpr Delivery kDelivery<DepthVerdictNote>{"DepthVerdict",  true,           true, 1,
                                                      milliseconds(0), milliseconds(0)};
template <>
inline constexpr Delivery kDelivery<LogHealth>{"LogHealth",      true, false, 1, milliseconds(500),
                                               milliseconds(500)};
template <>
inline constexpr Delivery kDelivery<Health>{"Health", true, false, 1, milliseconds(500), milliseconds(500)};

}  // namespace biopsy::transport
