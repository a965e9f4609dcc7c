// What a connection to the OpenIGTLink port sends: any bytes are read or refused, and no order of messages
// wishes motion of a robot that no person armed.
#include "robot/igtl/codec.hpp"
#include "robot/igtl/protocol.hpp"
#include "tests/verification/fuzz/target.hpp"

namespace {

using namespace biopsy;

igtl::RobotView view_of(std::uint8_t bits) {
  igtl::RobotView robot;
  robot.heard = robot.measured = true;
  robot.console = (bits & 1) == 0;
  robot.confirmed = robot.planned = (bits & 2) == 0;
  robot.answered = (bits >> 2) & 3;
  robot.steps = 1;
  robot.mode = static_cast<Mode>((bits >> 4) % kCount<Mode>);
  return robot;
}

}  // namespace

FUZZ(igtl) {
  if (bytes.empty()) return;
  igtl::Decoder decoder;
  decoder.feed(bytes.subspan(1));
  igtl::RobotProtocol protocol((bytes[0] & 1) == 0 ? igtl::Dialect::Of2013 : igtl::Dialect::Of2021);
  std::int64_t now_us = 0;
  try {
    while (const auto message = decoder.next()) {
      const igtl::RobotView robot = view_of(message->device.empty() ? bytes[0] : message->device.back());
      const bool moved = protocol.wish().motion;
      for (const igtl::Message& answer : protocol.receive(*message, robot, now_us += 100'000)) {
        igtl::Decoder client;
        client.feed(igtl::encode(answer, {}));
        biopsy::fuzz::claim(client.next() == answer, "an answer can be read, and is whole");
      }
      const bool armed = robot.mode == Mode::Armed || robot.mode == Mode::Active || robot.mode == Mode::Hold;
      biopsy::fuzz::claim(!protocol.wish().motion || moved || (armed && robot.confirmed && robot.console),
                          "motion is wished of an armed robot with a confirmed plan only");
    }
  } catch (const igtl::FramingLost& lost) {
    biopsy::fuzz::claim(!lost.why.empty(), "a lost connection says why");
  }
}
