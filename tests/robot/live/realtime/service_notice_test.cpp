// What systemd hears, on a socket of the test.
#include "robot/live/realtime/service_notice.hpp"

#include <gtest/gtest.h>
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
  set("NOTIFY_SOCKET", "/" + std::string(106, 'a'));
  EXPECT_NO_THROW(ServiceNotice());
}

TEST_F(Service, KnowsItsWatchdogAndNotThatOfItsParent) {
  set("WATCHDOG_USEC", "3000000");
  EXPECT_EQ(ServiceNotice().watchdog_us(), 3'000'000);
  set("WATCHDOG_PID", std::to_string(::getpid()));
  EXPECT_EQ(ServiceNotice().watchdog_us(), 3'000'000);
  set("WATCHDOG_PID", std::to_string(::getppid()));
  EXPECT_FALSE(ServiceNotice().watchdog_us());
  ::unsetenv("WATCHDOG_PID");
  for (const char* wrong : {"0", "-1", "3s", " 3", "1e6", "99999999999999999999"}) {
    set("WATCHDOG_USEC", wrong);
    EXPECT_THROW(ServiceNotice(), ConfigError) << wrong;
  }
}

}  // namespace
}  // namespace biopsy::realtime
