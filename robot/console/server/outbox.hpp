// What waits to be sent to one page. A slow page loses plots, never an answer or an alarm; one that does not
// even take those is cut off.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <string>

namespace biopsy::console {

enum class Worth { MayBeLost, MustArrive };

class Outbox {
 public:
  using Text = std::shared_ptr<const std::string>;

  void put(Text text, Worth worth) {
    if (worth == Worth::MayBeLost && bytes_ > kSlow_bytes) {
      ++lost_;
      return;
    }
    bytes_ += text->size();
    waiting_.push_back(std::move(text));
  }
  bool empty() const { return waiting_.empty(); }
  bool overflows() const { return bytes_ > kHopeless_bytes; }
  const std::string& front() const { return *waiting_.front(); }
  void pop() {
    bytes_ -= waiting_.front()->size();
    waiting_.pop_front();
  }
  std::size_t lost() const { return lost_; }

  // A second of plots; ten confirmation images.
  static constexpr std::size_t kSlow_bytes = 32'000, kHopeless_bytes = 16'000'000;

 private:
  std::deque<Text> waiting_;
  std::size_t bytes_ = 0, lost_ = 0;
};

}  // namespace biopsy::console
