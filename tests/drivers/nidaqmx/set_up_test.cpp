// What the stage refuses before anything moves, and what it leaves behind.
#include <gtest/gtest.h>

#include "tests/drivers/nidaqmx/stage_in_hand.hpp"
#include "tests/sim/plant/refusal.hpp"

namespace biopsy::nidaqmx {
namespace {

using fake::Board;

std::string refusal_with(const Config& config) {
  return sim::refusal([&] { const NidaqmxStage stage(config, fake_now_us); });
}

bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(NidaqmxSetUp, AbsentDriverSaysWhatToInstall) {
  Config config = laboratory();
  config.library = "/nowhere/libnidaqmx.so";
  const std::string refusal = refusal_with(config);
  EXPECT_TRUE(says(refusal, "/nowhere/libnidaqmx.so")) << refusal;
  EXPECT_TRUE(says(refusal, "install the NI-DAQmx driver")) << refusal;
}

TEST(NidaqmxSetUp, DriverThatLacksFunctionsNamesThem) {
  Config config = laboratory();
  config.library = HOLLOW_NIDAQMX;
  const std::string refusal = refusal_with(config);
  EXPECT_TRUE(says(refusal, "DAQmxReadAnalogF64")) << refusal;
  EXPECT_FALSE(says(refusal, "DAQmxGetSysDevNames")) << refusal;
}

TEST(NidaqmxSetUp, UnknownBoardListsThoseThatAreThere) {
  fake_reset();
  Config config = laboratory();
  config.device = "Dev9";
  EXPECT_TRUE(says(refusal_with(config), "Sim7, Dev1, Dev2"));
  config.device = "ev1";  // part of a name is no name
  EXPECT_NE(refusal_with(config), "accepted");
}

TEST(NidaqmxSetUp, AnotherBoardThanTheNamedOneIsRefused) {
  fake_reset();
  Config config = laboratory();
  config.serial = 30123456;
  EXPECT_EQ(refusal_with(config), "accepted");
  fake_reset()->serial = 7;
  EXPECT_TRUE(says(refusal_with(config), "serial number is 7, not 30123456"));
}

TEST(NidaqmxSetUp, EveryStepThatFailsIsRefusedInTheDriversOwnWordsAndLeavesNoTask) {
  for (const char* function :
       {"DAQmxGetSysDevNames", "DAQmxGetDevProductType", "DAQmxGetDevSerialNum", "DAQmxResetDevice",
        "DAQmxSelfTestDevice", "DAQmxCreateTask", "DAQmxTaskControl", "DAQmxStartTask",
        "DAQmxCreateAIVoltageChan", "DAQmxCreateAOVoltageChan", "DAQmxCreateDIChan", "DAQmxCreateDOChan",
        "DAQmxWriteAnalogScalarF64", "DAQmxWriteDigitalScalarU32"}) {
    fake_reset();
    fake_fail(function, -50103, -1);
    const std::string refusal = refusal_with(laboratory());
    EXPECT_TRUE(says(refusal, "-50103")) << function << ": " << refusal;
    EXPECT_TRUE(says(refusal, std::string("the test asked ") + function)) << refusal;
    EXPECT_TRUE(says(refusal, "close every other program")) << refusal;
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
    EXPECT_EQ(trouble_of(code), Trouble::Refused);
  for (const Status code : {-201003, -200324, -50405, -50400}) EXPECT_EQ(trouble_of(code), Trouble::Gone);
  for (const Status code : {-200279, -200278}) EXPECT_EQ(trouble_of(code), Trouble::Overrun);
  EXPECT_EQ(trouble_of(-200284), Trouble::Stale);
  EXPECT_EQ(trouble_of(-200088), Trouble::Fault);
  EXPECT_EQ(trouble_of(-1), Trouble::Fault) << "what nobody knows is the worst";
  EXPECT_EQ(trouble_of(0), Trouble::None);
  EXPECT_EQ(trouble_of(200010), Trouble::None) << "a warning";
}

}  // namespace
}  // namespace biopsy::nidaqmx
