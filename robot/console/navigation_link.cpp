#include "robot/console/navigation_link.hpp"

namespace biopsy::robot {
namespace {

constexpr std::int64_t kLookEvery_us = 20'000, kSendEvery_us = 100'000;

}  // namespace

std::optional<NavigationRequest> NavigationLink::newest(std::int64_t now_us) {
  const bool came = requests_.take_newest(request_) > 0;
  if (came || now_us - looked_us_ >= kLookEvery_us) {
    looked_us_ = now_us;
    alone_ = requests_.writers() == 1 && requests_.alive_writers() == 1;
  }
  if (!alone_ || request_.seq == 0) return std::nullopt;
  return request_;
}

void NavigationLink::answer(NavigationReply reply, std::int64_t now_us) {
  reply.seq = reply_.seq;
  if (reply == reply_ && now_us - sent_us_ < kSendEvery_us) return;
  ++reply.seq;
  replies_.write(reply);
  reply_ = reply;
  sent_us_ = now_us;
}

}  // namespace biopsy::robot
