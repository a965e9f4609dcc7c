// Server side of a hold-to-run button. A press needs a token that was issued for it and is accepted once;
// heartbeats keep it alive. One heartbeat that is late, or was delayed, ends the press for good: the hand may
// be gone.
#pragma once

#include <cstdint>
#include <optional>

namespace biopsy::console {

// The page sends a heartbeat every 25 ms: three may be missing. Equal to the supervisor's limit for the
// console.
inline constexpr std::int64_t kBeatMax_us = 100'000;
// Delay of a heartbeat beyond the fastest one of its press: page or connection did not respond.
inline constexpr double kDelayMax_ms = 100.0;

class HoldToRun {
 public:
  // Tokens increase from `first`. The supervisor checks them too, so `first` must exceed those of earlier
  // starts.
  explicit HoldToRun(std::uint32_t first) : next_(first) {}

  // The token that the next press must have.
  std::uint32_t next_token() const { return next_; }

  // False: not the issued token, or another press is active. `now_us` is the server's clock, `page_ms` the
  // page's; only differences of each are used.
  bool press(std::uint32_t token, double page_ms, std::int64_t now_us);
  void beat(std::uint32_t token, double page_ms, std::int64_t now_us);
  void release(std::uint32_t token);
  void cancel() { pressed_.reset(); }

  // The token of the active press.
  std::optional<std::uint32_t> held(std::int64_t now_us);
  std::int64_t held_for_us(std::int64_t now_us);

 private:
  struct Pressed {
    std::uint32_t token = 0;
    std::int64_t since_us = 0, beat_us = 0;
    double page_ms = 0.0;     // of the newest heartbeat
    double fastest_ms = 0.0;  // minimum (arrival - sending) of this press, across two clocks
  };
  std::uint32_t next_;
  std::optional<Pressed> pressed_;
};

}  // namespace biopsy::console
