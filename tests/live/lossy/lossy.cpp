// A network that loses packets, to be preloaded into a process: of what it sends over IPv4, as many in a
// thousand as the file named by LOSSY_FILE says at that moment are gone without a word.
#include <dlfcn.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>

namespace {

using Share = const std::atomic<std::uint32_t>;

Share* share() {
  const char* name = std::getenv("LOSSY_FILE");
  const int file = name == nullptr ? -1 : open(name, O_RDONLY);
  if (file < 0) return nullptr;
  void* mapped = mmap(nullptr, sizeof(Share), PROT_READ, MAP_SHARED, file, 0);
  close(file);
  return mapped == MAP_FAILED ? nullptr : static_cast<Share*>(mapped);
}

// Scattered, and the same for the same number of packets.
bool is_lost(std::uint32_t per_mille) {
  static std::atomic<std::uint64_t> sent{static_cast<std::uint64_t>(getpid()) << 32U};
  std::uint64_t z = sent++ * 0x9E37'79B9'7F4A'7C15ULL;
  z = (z ^ (z >> 30U)) * 0xBF58'476D'1CE4'E5B9ULL;
  return (z >> 33U) % 1'000 < per_mille;
}

}  // namespace

extern "C" ssize_t sendmsg(int socket, const msghdr* message, int flags) {
  using Send = ssize_t (*)(int, const msghdr*, int);
  static const auto real = reinterpret_cast<Send>(dlsym(RTLD_NEXT, "sendmsg"));
  static Share* const lost = share();
  const auto* to = static_cast<const sockaddr*>(message->msg_name);
  if (lost == nullptr || to == nullptr || to->sa_family != AF_INET || !is_lost(*lost))
    return real(socket, message, flags);
  ssize_t length = 0;
  for (std::size_t i = 0; i < message->msg_iovlen; ++i)
    length += static_cast<ssize_t>(message->msg_iov[i].iov_len);
  return length;
}
