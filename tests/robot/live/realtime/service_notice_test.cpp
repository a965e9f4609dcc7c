// What systemd hears, on a socket of the test.
#include "robot/live/realtime/service_notice.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <string>

#include "robot/common/config_error.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::realtime {
namespace {

// systemd's end. `name` as in $NOTIFY_SOCKET: a path, or @ and an abstract name.
class Listener {
 public:
  explicit Listener(const std::string& name) : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, name.data(), name.size());
    if (name[0] == '@') address.sun_path[0] = '\0';
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
    EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&address), size), 0) << name;
  }
  ~Listener() { ::close(socket_); }

  std::string next() const {  // "" if nothing came
    std::array<char, 1024> text{};
    const ssize_t size = ::recv(socket_, text.data(), text.size(), MSG_DONTWAIT);
    return {text.data(), size < 0 ? 0 : static_cast<std::size_t>(size)};
  }

 private:
  int socket_;
};

class Service : public testing::Test {
 protected:
  Service() { unset(); }
  ~Service() override { unset(); }
  static void unset() {
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) ::unsetenv(name);
  }
  static void set(const char* name, const std::string& value) { ::setenv(name, value.c_str(), 1); }

  ScratchFolder folder_;
};

TEST_F(Service, TellsSystemdOverAPathOrAnAbstractName) {
  for (const std::string& name :
       {(folder_ / "notify").string(), "@biopsy-test-" + std::to_string(::getpid())}) {
    const Listener systemd(name);
    set("NOTIFY_SOCKET", name);
    const ServiceNotice notice;
    EXPECT_TRUE(notice.anybody_listens());
    EXPECT_TRUE(notice.ready());
    EXPECT_EQ(systemd.next(), "READY=1");
    EXPECT_TRUE(notice.watchdog());
    EXPECT_EQ(systemd.next(), "WATCHDOG=1");
    EXPECT_TRUE(notice.status("armed, 2.0 mm"));
    EXPECT_EQ(systemd.next(), "STATUS=armed, 2.0 mm");
    EXPECT_TRUE(notice.stopping());
    EXPECT_EQ(systemd.next(), "STOPPING=1");
    EXPECT_EQ(systemd.next(), "");
  }
}

TEST_F(Service, StatusIsOneLineAndCannotSmuggleInAnotherNotice) {
  const std::string name = (folder_ / "notify").string();
  const Listener systemd(name);
  set("NOTIFY_SOCKET", name);
  const ServiceNotice notice;
  EXPECT_TRUE(notice.status("case a\nMAINPID=1"));
  EXPECT_EQ(systemd.next(), "STATUS=case a");
  EXPECT_TRUE(notice.status(std::string(5'000, 'x')));
  EXPECT_EQ(systemd.next(), "STATUS=" + std::string(200, 'x'));
  EXPECT_TRUE(notice.status(""));
  EXPECT_EQ(systemd.next(), "STATUS=");
}

TEST_F(Service, SaysNothingWhereNobodyListens) {
  const ServiceNotice alone;
  EXPECT_FALSE(alone.anybody_listens());
  EXPECT_FALSE(alone.ready());
  EXPECT_FALSE(alone.watchdog_us());
  set("NOTIFY_SOCKET", (folder_ / "gone").string());
  const ServiceNotice deaf;
  EXPECT_FALSE(deaf.ready()) << "a socket nobody has bound";
}

TEST_F(Service, NeverWaitsForAListenerThatDoesNotListen) {
  const std::string name = (folder_ / "notify").string();
  const Listener systemd(name);
  set("NOTIFY_SOCKET", name);
  const ServiceNotice notice;
  bool full = false;
  for (int i = 0; i < 100'000 && !full; ++i) full = !notice.watchdog();
  EXPECT_TRUE(full);
}

TEST_F(Service, RefusesAnAddressThatIsNone) {
  for (const std::string& name :
       {std::string("notify"), std::string("/"), std::string("@"), "/" + std::string(107, 'a')}) {
    set("NOTIFY_SOCKET", name);
    EXPECT_THROW(ServiceNotice(), ConfigError) << name;
  }
  set("NOTIFY_SOCKET", "/" + std::string(150, 'a'));
  EXPECT_THROW(ServiceNotice(), ConfigError);
  for (const std::string& name : {"/" + std::string(106, 'a'), std::string("/n"), std::string("@n")}) {
    set("NOTIFY_SOCKET", name);
    EXPECT_NO_THROW(ServiceNotice()) << name;
  }
}

TEST_F(Service, RefusesToBeginWithoutADescriptorLeft) {
  set("NOTIFY_SOCKET", (folder_ / "notify").string());
  rlimit before{};
  ::getrlimit(RLIMIT_NOFILE, &before);
  const rlimit none{0, before.rlim_max};
  ::setrlimit(RLIMIT_NOFILE, &none);
  EXPECT_THROW(ServiceNotice(), ConfigError);
  ::setrlimit(RLIMIT_NOFILE, &before);
}

// Each of a program that this one starts is one less for it, and one more to keep open.
TEST_F(Service, ItsDescriptorIsItsOwnAndGoneAtItsEnd) {
  set("NOTIFY_SOCKET", (folder_ / "notify").string());
  const int next = ::dup(1);  // the lowest that is free, and so the socket's
  ::close(next);
  {
    const ServiceNotice notice;
    EXPECT_EQ(::fcntl(next, F_GETFD), FD_CLOEXEC);
  }
  EXPECT_EQ(::fcntl(next, F_GETFD), -1);
}

TEST_F(Service, WorksOnDescriptor0Too) {
  const std::string name = (folder_ / "notify").string();
  const Listener systemd(name);
  set("NOTIFY_SOCKET", name);
  const int input = ::dup(0);
  ::close(0);
  {
    const ServiceNotice notice;
    EXPECT_TRUE(notice.anybody_listens());
    EXPECT_TRUE(notice.ready());
  }
  EXPECT_EQ(::fcntl(0, F_GETFD), -1) << "closed";
  ::dup2(input, 0);
  ::close(input);
  EXPECT_EQ(systemd.next(), "READY=1");
}

TEST_F(Service, KnowsItsWatchdogAndNotThatOfItsParent) {
  set("WATCHDOG_USEC", "3000000");
  EXPECT_EQ(ServiceNotice().watchdog_us(), 3'000'000);
  set("WATCHDOG_PID", std::to_string(::getpid()));
  EXPECT_EQ(ServiceNotice().watchdog_us(), 3'000'000);
  for (const pid_t other : {::getppid(), ::getpid() - 1, ::getpid() + 1}) {
    set("WATCHDOG_PID", std::to_string(other));
    EXPECT_FALSE(ServiceNotice().watchdog_us());
  }
  ::unsetenv("WATCHDOG_PID");
  set("WATCHDOG_USEC", "1");
  EXPECT_EQ(ServiceNotice().watchdog_us(), 1);
  for (const char* wrong : {"0", "-1", "3s", " 3", "1e6", "99999999999999999999"}) {
    set("WATCHDOG_USEC", wrong);
    EXPECT_THROW(ServiceNotice(), ConfigError) << wrong;
  }
}

}  // namespace
}  // namespace biopsy::realtime
