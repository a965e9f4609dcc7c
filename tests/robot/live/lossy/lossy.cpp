// A bad network, to be preloaded into a process: of what it sends over IPv4, as many in a thousand as the
// file named by LOSSY_FILE says at that moment are lost without a word, sent twice, or sent behind the next
// one. It counts in the same file what it did.
#include <dlfcn.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <vector>

namespace {

using Send = ssize_t (*)(int, const msghdr*, int);

struct Trouble {
  std::atomic<std::uint32_t> lost, doubled, late;              // of a thousand
  std::atomic<std::uint32_t> lost_sum, doubled_sum, late_sum;  // so far
};

Trouble* trouble() {
  const char* name = std::getenv("LOSSY_FILE");
  const int file = name == nullptr ? -1 : open(name, O_RDWR);
  if (file < 0) return nullptr;
  void* mapped = mmap(nullptr, sizeof(Trouble), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  close(file);
  return mapped == MAP_FAILED ? nullptr : static_cast<Trouble*>(mapped);
}

// Scattered over 0 to 999, and the same for the same number of packets.
std::uint32_t drawn() {
  static std::atomic<std::uint64_t> sent{static_cast<std::uint64_t>(getpid()) << 32U};
  std::uint64_t z = sent++ * 0x9E37'79B9'7F4A'7C15ULL;
  z = (z ^ (z >> 30U)) * 0xBF58'476D'1CE4'E5B9ULL;
  return static_cast<std::uint32_t>((z >> 33U) % 1'000);
}

// One packet that waits for the next.
struct Held {
  std::mutex mutex;
  int socket = -1;
  sockaddr_in to{};
  std::vector<std::uint8_t> bytes;  // empty: none
};

Held& held() {
  static Held packet;
  return packet;
}

ssize_t size_of(const msghdr* message) {
  std::size_t size = 0;
  for (std::size_t i = 0; i < message->msg_iovlen; ++i) size += message->msg_iov[i].iov_len;
  return static_cast<ssize_t>(size);
}

bool hold(int socket, const msghdr* message) {
  Held& packet = held();
  const std::lock_guard lock(packet.mutex);
  if (!packet.bytes.empty()) return false;
  packet.socket = socket;
  packet.to = *static_cast<const sockaddr_in*>(message->msg_name);
  for (std::size_t i = 0; i < message->msg_iovlen; ++i) {
    const auto* from = static_cast<const std::uint8_t*>(message->msg_iov[i].iov_base);
    packet.bytes.insert(packet.bytes.end(), from, from + message->msg_iov[i].iov_len);
  }
  return true;
}

void let_go(Send real) {
  Held& packet = held();
  const std::lock_guard lock(packet.mutex);
  if (packet.bytes.empty()) return;
  iovec part{packet.bytes.data(), packet.bytes.size()};
  msghdr message{};
  message.msg_name = &packet.to;
  message.msg_namelen = sizeof packet.to;
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  real(packet.socket, &message, 0);
  packet.bytes.clear();
}

}  // namespace

extern "C" ssize_t sendmsg(int socket, const msghdr* message, int flags) {
  static const auto real = reinterpret_cast<Send>(dlsym(RTLD_NEXT, "sendmsg"));
  static Trouble* const wire = trouble();
  const auto* to = static_cast<const sockaddr*>(message->msg_name);
  if (wire == nullptr || to == nullptr || to->sa_family != AF_INET) return real(socket, message, flags);
  std::uint32_t draw = drawn();
  const auto takes = [&draw](std::uint32_t share, std::atomic<std::uint32_t>& sum) {
    const bool taken = draw < share;
    draw -= taken ? 0 : share;
    sum += taken ? 1 : 0;
    return taken;
  };
  if (takes(wire->lost, wire->lost_sum)) return size_of(message);
  const bool doubled = takes(wire->doubled, wire->doubled_sum);
  if (!doubled && takes(wire->late, wire->late_sum) && hold(socket, message)) return size_of(message);
  const ssize_t sent = real(socket, message, flags);
  if (doubled) real(socket, message, flags);
  let_go(real);
  return sent;
}
