// A button that acts only while it is held, as seen from the server. A press needs a token that was given out
// for it and is accepted once; it lives on beats. One beat that comes late, or was long on its way, ends the
// press for good: what arrives afterwards is of a hand that may be gone.
#pragma once

#include <cstdint>
#include <optional>

namespace biopsy::console {

// The page beats every 25 ms: three may be missing. As long as the supervisor itself waits for a console.
inline constexpr std::int64_t kBeatMax_us = 100'000;
// A beat that took so much longer than the quickest one of its press waited somewhere: a page or a link that
// hung.
inline constexpr double kDelayMax_ms = 100.0;

class HoldToRun {
 public:
  // Tokens rise from `first`; the supervisor knows them too, so that of a new start must be above those
  // before.
  explicit HoldToRun(std::uint32_t first) : next_(first) {}

  // What the next press must bring.
  std::uint32_t next_token() const { return next_; }

  // False: not the token that was given out, or another press is under way. Times: `now_us` of the server,
  // `page_ms` of the page; only differences of each count.
  bool press(std::uint32_t token, double page_ms, std::int64_t now_us);
  void beat(std::uint32_t token, double page_ms, std::int64_t now_us);
  void release(std::uint32_t token);
  void drop() { pressed_.reset(); }

  // The token of the press that lives now.
  std::optional<std::uint32_t> held(std::int64_t now_us);
  std::int64_t held_for_us(std::int64_t now_us);

 private:
  struct Pressed {
    std::uint32_t token = 0;
    std::int64_t since_us = 0, beat_us = 0;
    double page_ms = 0.0;      // of the newest beat
    double quickest_ms = 0.0;  // smallest (arrival - sending) of this press, in two clocks
  };
  std::uint32_t next_;
  std::optional<Pressed> pressed_;
};

}  // namespace biopsy::console
