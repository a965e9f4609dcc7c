// Opening the stage: what is refused, and the state at start and end.
#include <gtest/gtest.h>

#include "tests/drivers/nidaqmx/fake_board_config.hpp"
#include "tests/sim/plant/refusal.hpp"

namespace biopsy::nidaqmx {
namespace {

using fake::Board;

std::string refusal_with(const Config& config) {
  return sim::refusal([&] { const NidaqmxStage stage(config, fake_now_us); });
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(NidaqmxSetUp, MissingDriverIsRefusedWithWhatToInstall) {
  Config config = laboratory();
  config.library = "/nowhere/libnidaqmx.so";
  const std::string refusal = refusal_with(config);
  EXPECT_TRUE(contains(refusal, "/nowhere/libnidaqmx.so")) << refusal;
  EXPECT_TRUE(contains(refusal, "install the NI-DAQmx driver")) << refusal;
}

TEST(NidaqmxSetUp, DriverThatLacksFunctionsNamesThem) {
  Config config = laboratory();
  config.library = HOLLOW_NIDAQMX;
  const std::string refusal = refusal_with(config);
  EXPECT_TRUE(contains(refusal, "DAQmxReadAnalogF64")) << refusal;
  EXPECT_FALSE(contains(refusal, "DAQmxGetSysDevNames")) << refusal;
}

TEST(NidaqmxSetUp, UnknownBoardIsRefusedWithTheListOfBoards) {
  fake_reset();
  Config config = laboratory();
  config.device = "Dev9";
  EXPECT_TRUE(contains(refusal_with(config), "Sim7, Dev1, Dev2"));
  config.device = "ev1";  // part of a name is no name
  EXPECT_NE(refusal_with(config), "accepted");
}

TEST(NidaqmxSetUp, AnotherBoardThanTheNamedOneIsRefused) {
  fake_reset();
  Config config = laboratory();
  config.serial = 30123456;
  EXPECT_EQ(refusal_with(config), "accepted");
  fake_reset()->serial = 7;
  EXPECT_TRUE(contains(refusal_with(config), "serial number is 7, not 30123456"));
}

TEST(NidaqmxSetUp, EveryFailingStepIsRefusedWithTheDriversTextAndLeavesNoTask) {
  for (const char* function :
       {"DAQmxGetSysDevNames", "DAQmxGetDevProductType", "DAQmxGetDevSerialNum", "DAQmxResetDevice",
        "DAQmxSelfTestDevice", "DAQmxCreateTask", "DAQmxTaskControl", "DAQmxStartTask",
        "DAQmxCreateAIVoltageChan", "DAQmxCreateAOVoltageChan", "DAQmxCreateDIChan", "DAQmxCreateDOChan",
        "DAQmxWriteAnalogScalarF64", "DAQmxWriteDigitalScalarU32"}) {
    fake_reset();
    fake_fail(function, -50103, -1);
    const std::string refusal = refusal_with(laboratory());
    EXPECT_TRUE(contains(refusal, "-50103")) << function << ": " << refusal;
    EXPECT_TRUE(contains(refusal, std::string("the test lets ") + function)) << refusal;
    EXPECT_TRUE(contains(refusal, "close every other program")) << refusal;
    EXPECT_EQ(fake_board()->tasks, 0) << function;
  }
}

TEST(NidaqmxSetUp, StartsAndEndsAtZeroVoltsWhateverTheConverterHeld) {
  Board* const board = fake_reset();
  board->output_V = 4.2;  // left by a program that crashed
  {
    NidaqmxStage stage(laboratory(), fake_now_us);
    EXPECT_EQ(board->output_V, 0.0);
    board->output_V = 3.3;
    board->lines = 0b10;
  }
  EXPECT_EQ(board->output_V, 0.0);
  EXPECT_EQ(board->lines, 0U);
  EXPECT_EQ(board->tasks, 0);
}

TEST(NidaqmxSetUp, EveryKnownCodeHasItsMeaning) {
  for (const Status code : {-200077, -200170, -200220, -50103, -200022})
    EXPECT_EQ(error_kind(code), ErrorKind::Refused);
  for (const Status code : {-201003, -200324, -50405, -50400}) EXPECT_EQ(error_kind(code), ErrorKind::Gone);
  for (const Status code : {-200279, -200278}) EXPECT_EQ(error_kind(code), ErrorKind::Overrun);
  EXPECT_EQ(error_kind(-200284), ErrorKind::Stale);
  EXPECT_EQ(error_kind(-200088), ErrorKind::Fault);
  EXPECT_EQ(error_kind(-1), ErrorKind::Fault) << "an unknown code is the worst";
  EXPECT_EQ(error_kind(0), ErrorKind::None);
  EXPECT_EQ(error_kind(200010), ErrorKind::None) << "a warning";
}

}  // namespace
}  // namespace biopsy::nidaqmx
