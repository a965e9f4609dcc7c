#include "tests/drivers/nidaqmx/fake/fake_board.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "sim/plant/seeded_noise.hpp"

namespace {

using biopsy::fake::Board;
using Status = std::int32_t;
namespace sim = biopsy::sim;

constexpr std::uint32_t kEstopContacts = 0b1100;
constexpr Status kInvalidTask = -200088, kNoSuchDevice = -200220, kNoSuchChannel = -200170;

struct Input {
  std::string channel;
  double low_V, high_V;
};

struct BoardTask {
  std::vector<Input> inputs;
  std::uint32_t lines = 0;  // that it may write, or reads
  bool of_supervisor = false;
  enum class Kind { None, AnalogInput, AnalogOutput, DigitalInput, DigitalOutput } kind = Kind::None;
  bool started = false;
};

struct Failure {
  std::string function;
  Status status;
  int times;
};

std::unique_ptr<Board> at_rest() {
  auto made = std::make_unique<Board>();
  made->plant = sim::at_rest(made->model);
  return made;
}

std::unique_ptr<Board> board = at_rest();
std::map<void*, std::unique_ptr<BoardTask>> tasks;
std::vector<Failure> failures;
char driver_text[256] = "no error";

// Live, the two boards belong to two processes. The relay, which hears both, is then a word in a file that
// both map: when the supervisor's pulse last changed. Null where the test names no file.
std::atomic<std::int64_t>* shared_relay() {
  static std::atomic<std::int64_t>* const word = []() -> std::atomic<std::int64_t>* {
    const char* file = std::getenv("FAKE_NIDAQMX_RELAY");
    if (file == nullptr) return nullptr;
    const int descriptor = open(file, O_RDWR | O_CREAT, 0600);
    void* page = MAP_FAILED;
    if (descriptor >= 0 && ftruncate(descriptor, sizeof *word) == 0)
      page = mmap(nullptr, sizeof *word, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
    if (descriptor >= 0) close(descriptor);
    return page == MAP_FAILED ? nullptr : static_cast<std::atomic<std::int64_t>*>(page);
  }();
  return word;
}

std::int64_t monotonic_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1'000'000'000 + now.tv_nsec;
}

// A person at the panel, once a second: presses the emergency stop, releases it and turns the reset key.
std::uint32_t contacts_with_hand() {
  constexpr std::uint32_t kReset = 0b10;
  if (shared_relay() == nullptr) return board->contacts;
  const std::int64_t ms = board->now_us / 1'000 % 1'000;
  if (board->now_us > 4'000'000) return board->contacts;
  if (ms >= 200 && ms < 300) return board->contacts & ~kEstopContacts;
  return ms >= 400 && ms < 500 ? board->contacts | kReset : board->contacts.load();
}

// Allocates nothing: tests count the allocations of the driver.
Status answer(Status status, const char* text, const char* function = "") {
  std::snprintf(driver_text, sizeof driver_text, text, function);
  return status;
}

// The status that a test has set for this function; 0: none.
Status failure_of(const char* function) {
  for (Failure& failure : failures) {
    if (failure.function != function || failure.times == 0) continue;
    if (failure.times > 0) --failure.times;
    return answer(failure.status, "the test lets %s fail", function);
  }
  return 0;
}

BoardTask* task_of(void* handle) {
  const auto found = tasks.find(handle);
  return found == tasks.end() ? nullptr : found->second.get();
}

// The emergency stop switches the amplifier off by itself.
bool is_pressed() {
  return (board->contacts & kEstopContacts) != kEstopContacts && board->dead_contacts != kEstopContacts;
}

bool is_relay_closed() {
  const bool closed = board->now_us - board->pulse_us < board->interlock_us;
  const std::atomic<std::int64_t>* shared = shared_relay();
  if (shared != nullptr) return closed && monotonic_ns() - *shared < board->interlock_us * 1'000;
  const bool supervised = board->supervisor_us < 0 || !board->has_supervisors_half ||
                          board->now_us - board->supervisor_us < board->interlock_us;
  return !board->has_interlock || (closed && supervised);
}

bool is_powered() {
  return is_relay_closed() && !is_pressed() && (board->lines >> 1U & 1U) != 0;
}

void pass_one_tick() {
  if (board->press_under_voltage > 0 && board->output_V != 0.0 && --board->press_under_voltage == 0)
    board->contacts &= ~(kEstopContacts & ~board->dead_contacts);
  const double volts = is_powered() ? board->output_V * 1e3 : 0.0;
  const sim::PlantInputs inputs{.voltage = volts, .external_force = board->push_N};
  board->plant = sim::step(board->model, board->plant, inputs, biopsy::Seconds(1e-3));
  board->now_us += 1'000;
}

double laser_V() {
  const double depth_mm = sim::displacement_reading(board->model, board->plant) * 1e3;
  return board->laser_zero_V + depth_mm / board->laser_mm_per_V;
}

// As a converter of 16 bits with noise would show it.
double converted(const Input& input) {
  const sim::NormalPair noise =
      sim::normals(static_cast<std::uint64_t>(input.channel.back()), board->plant.readings);
  double volts = 0.0;
  if (input.channel == "Dev1/ai0") volts = laser_V() + board->laser_noise_V * noise.first;
  if (input.channel == "Dev1/ai1")
    volts = board->plant.u_i * 1e-3 * board->monitor_gain + board->monitor_offset_V +
            board->monitor_noise_V * noise.first;
  if (input.channel == "Dev1/ai2") volts = board->plant.charge / 1e-3 * 1e3 / 4.0 + 1e-5 * noise.first;
  if (input.channel == "Dev1/ai3")
    volts = board->laser_zero_V + board->plant.motion.x * 1e3 / board->laser_mm_per_V +
            board->laser_noise_V * noise.first;
  if (input.channel == "Dev1/ai4") volts = is_relay_closed() ? 5.0 : 0.0;
  if (input.channel == "Dev1/ai0" && board->laser_stuck) volts = board->laser_stuck_V;
  const double step_V = (input.high_V - input.low_V) / 65536.0;
  return std::clamp(std::round(volts / step_V) * step_V, input.low_V, input.high_V);
}

Status copy(const char* text, char* out, std::uint32_t size) {
  std::snprintf(out, size, "%s", text);
  return 0;
}

bool is_ours(const char* device) {
  return std::strcmp(device, "Dev1") == 0;
}

}  // namespace

#define FAIL_AS_SET(function) \
  if (const Status set = failure_of(function); set != 0) return set
#define TASK_OR_FAIL(name, handle)         \
  BoardTask* const name = task_of(handle); \
  if (name == nullptr) return answer(kInvalidTask, "Task specified is invalid or does not exist.")
#define ENTER(function, name, handle) \
  FAIL_AS_SET(function);              \
  TASK_OR_FAIL(name, handle)

extern "C" {

Board* fake_reset() {
  board = at_rest();
  tasks.clear();
  failures.clear();
  return board.get();
}

Board* fake_board() {
  return board.get();
}

void fake_fail(const char* function, Status status, int times) {
  std::erase_if(failures, [&](const Failure& failure) { return failure.function == function; });
  failures.push_back({function, status, times});
}

std::int64_t fake_now_us() {
  return board->now_us;
}

Status DAQmxGetExtendedErrorInfo(char* text, std::uint32_t size) {
  return copy(driver_text, text, size);
}

Status DAQmxGetSysDevNames(char* names, std::uint32_t size) {
  FAIL_AS_SET("DAQmxGetSysDevNames");
  return copy("Sim7, Dev1, Dev2", names, size);
}

Status DAQmxGetDevProductType(const char*, char* text, std::uint32_t size) {
  FAIL_AS_SET("DAQmxGetDevProductType");
  return copy("USB-6211", text, size);
}

Status DAQmxGetDevSerialNum(const char*, std::uint32_t* serial) {
  FAIL_AS_SET("DAQmxGetDevSerialNum");
  *serial = board->serial;
  return 0;
}

Status DAQmxResetDevice(const char* device) {
  FAIL_AS_SET("DAQmxResetDevice");
  if (!is_ours(device)) return answer(kNoSuchDevice, "Device identifier is invalid.");
  board->output_V = 0.0;
  board->lines = 0;
  return 0;
}

Status DAQmxSelfTestDevice(const char*) {
  FAIL_AS_SET("DAQmxSelfTestDevice");
  return 0;
}

Status DAQmxCreateTask(const char*, void** handle) {
  FAIL_AS_SET("DAQmxCreateTask");
  auto task = std::make_unique<BoardTask>();
  *handle = task.get();
  tasks[*handle] = std::move(task);
  ++board->tasks;
  return 0;
}

Status DAQmxTaskControl(void* handle, std::int32_t) {
  ENTER("DAQmxTaskControl", task, handle);
  return static_cast<void>(task), 0;
}

Status DAQmxStartTask(void* handle) {
  ENTER("DAQmxStartTask", task, handle);
  task->started = true;
  return 0;
}

Status DAQmxStopTask(void* handle) {
  TASK_OR_FAIL(task, handle);
  task->started = false;
  return 0;
}

Status DAQmxClearTask(void* handle) {
  TASK_OR_FAIL(task, handle);
  tasks.erase(static_cast<void*>(task));
  --board->tasks;
  return 0;
}

Status DAQmxCreateAIVoltageChan(void* handle, const char* channel, const char*, std::int32_t terminal,
                                double low, double high, std::int32_t units, const char*) {
  ENTER("DAQmxCreateAIVoltageChan", task, handle);
  const std::set<std::int32_t> terminals{10083, 10078, 10106};
  if (std::strncmp(channel, "Dev1/ai", 7) != 0)
    return answer(kNoSuchChannel, "Physical channel does not exist.");
  if (!terminals.contains(terminal) || units != 10348 || low >= high)
    return answer(-200077, "Value not supported.");
  task->inputs.push_back({channel, low, high});
  return 0;
}

Status DAQmxCreateAOVoltageChan(void* handle, const char* channel, const char*, double low, double high,
                                std::int32_t units, const char*) {
  ENTER("DAQmxCreateAOVoltageChan", task, handle);
  task->kind = BoardTask::Kind::AnalogOutput;
  if (std::strcmp(channel, "Dev1/ao0") != 0)
    return answer(kNoSuchChannel, "Physical channel does not exist.");
  return units == 10348 && low == -10.0 && high == 10.0 ? 0 : answer(-200077, "Value not supported.");
}

Status DAQmxCreateDIChan(void* handle, const char* lines, const char*, std::int32_t) {
  ENTER("DAQmxCreateDIChan", task, handle);
  task->kind = BoardTask::Kind::DigitalInput;
  for (std::uint32_t line = 0; line < 8; ++line)
    if (std::strstr(lines, ("Dev1/port0/line" + std::to_string(line)).c_str()) != nullptr)
      task->lines |= 1U << line;
  return task->lines != 0 ? 0 : answer(kNoSuchChannel, "Physical channel does not exist.");
}

Status DAQmxCreateDOChan(void* handle, const char* lines, const char*, std::int32_t) {
  ENTER("DAQmxCreateDOChan", task, handle);
  task->kind = BoardTask::Kind::DigitalOutput;
  for (std::uint32_t line = 0; line < 4; ++line)
    if (std::strstr(lines, ("Dev1/port1/line" + std::to_string(line)).c_str()) != nullptr)
      task->lines |= 1U << line;
  task->of_supervisor = std::strcmp(lines, board->supervisor_wire) == 0;
  return task->lines != 0 || task->of_supervisor ? 0
                                                 : answer(kNoSuchChannel, "Physical channel does not exist.");
}

Status DAQmxReadAnalogF64(void* handle, std::int32_t samples, double, std::uint32_t, double* volts,
                          std::uint32_t size, std::int32_t* read, std::uint32_t*) {
  ENTER("DAQmxReadAnalogF64", task, handle);
  if (!task->started || samples != 1 || size < task->inputs.size())
    return answer(-200229, "Buffer is too small.");
  if (!board->laser_stuck) board->laser_stuck_V = laser_V();
  for (const Input& input : task->inputs) *volts++ = converted(input);
  *read = 1;
  return 0;
}

Status DAQmxReadDigitalScalarU32(void* handle, double, std::uint32_t* lines, std::uint32_t*) {
  ENTER("DAQmxReadDigitalScalarU32", task, handle);
  if (!task->started || task->kind != BoardTask::Kind::DigitalInput)
    return answer(-200983, "You only can read from a task of this kind that was started.");
  *lines = contacts_with_hand() & task->lines;
  return 0;
}

Status DAQmxWriteAnalogScalarF64(void* handle, std::uint32_t, double, double volts, std::uint32_t*) {
  ENTER("DAQmxWriteAnalogScalarF64", task, handle);
  if (!task->started || task->kind != BoardTask::Kind::AnalogOutput)
    return answer(-200846, "Write cannot be performed: another kind of task, or one not started.");
  if (!(std::abs(volts) <= 10.0)) return answer(-200077, "Requested value is not supported.");
  board->output_V = volts;
  board->highest_V = std::max(board->highest_V, std::abs(volts));
  pass_one_tick();
  return static_cast<void>(task), 0;
}

Status DAQmxWriteDigitalScalarU32(void* handle, std::uint32_t, double, std::uint32_t lines, std::uint32_t*) {
  ENTER("DAQmxWriteDigitalScalarU32", task, handle);
  if (!task->started || task->kind != BoardTask::Kind::DigitalOutput)
    return answer(-200846, "Write cannot be performed: another kind of task, or one not started.");
  if (task->of_supervisor) {
    const bool high = (lines >> board->supervisor_line & 1U) != 0;
    if (board->supervisor_high != high) {
      board->supervisor_us = board->now_us;
      if (shared_relay() != nullptr) *shared_relay() = monotonic_ns();
    }
    board->supervisor_high = high;
    return 0;
  }
  const std::uint32_t next = (board->lines & ~task->lines) | (lines & task->lines);
  if (((next ^ board->lines) & 1U) != 0) board->pulse_us = board->now_us;
  board->lines = next;
  return 0;
}

}  // extern "C"
