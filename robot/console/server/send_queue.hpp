// Messages that wait to be sent to one page. On a slow connection plot data are dropped, never an answer or
// an alarm; a connection that does not take those either is closed.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <string>

namespace biopsy::console {

enum class Reliability { BestEffort, Reliable };

class SendQueue {
 public:
  using Text = std::shared_ptr<const std::string>;

  void push(Text text, Reliability reliability) {
    if (reliability == Reliability::BestEffort && bytes_ > kBestEffortMax_bytes) return;
    bytes_ += text->size();
    waiting_.push_back(std::move(text));
  }
  bool empty() const { return waiting_.empty(); }
  bool overflows() const { return bytes_ > kReliableMax_bytes; }
  const std::string& front() const { return *waiting_.front(); }
  void pop() {
    bytes_ -= waiting_.front()->size();
    waiting_.pop_front();
  }

  // A second of plots; ten confirmation images.
  static constexpr std::size_t kBestEffortMax_bytes = 32'000, kReliableMax_bytes = 16'000'000;

 private:
  std::deque<Text> waiting_;
  std::size_t bytes_ = 0;
};

}  // namespace biopsy::console
