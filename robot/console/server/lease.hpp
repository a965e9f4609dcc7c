// One page controls, all others watch. A page keeps the lease while it is connected; another one gets it only
// once it is free.
#pragma once

#include <cstdint>
#include <optional>

namespace biopsy::console {

using Client = std::uint64_t;

class Lease {
 public:
  // True: `client` holds it now.
  bool take(Client client) {
    if (!holder_) holder_ = client;
    return *holder_ == client;
  }
  // True: it was the holder.
  bool release(Client client) {
    if (holder_ != client) return false;
    holder_.reset();
    return true;
  }
  bool is_held() const { return holder_.has_value(); }
  bool is_held_by(Client client) const { return holder_ == client; }

 private:
  std::optional<Client> holder_;
};

}  // namespace biopsy::console
