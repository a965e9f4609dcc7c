// A mutated file is read or refused with a ConfigError; nothing else, and no crash.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "robot/common/files/file.hpp"
#include "sim/plant/dataset.hpp"
#include "sim/plant/simulate.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/sim/effects/staged_model.hpp"
#include "tests/sim/plant/refusal.hpp"

namespace biopsy::sim {
namespace {

class Mutator {
 public:
  explicit Mutator(std::uint32_t seed) : random_(seed) {}

  std::string operator()(std::string text) {
    const auto rounds = 1 + below(4);
    for (std::size_t i = 0; i < rounds && !text.empty(); ++i) mutate(text);
    return text;
  }

 private:
  std::size_t below(std::size_t n) { return random_() % n; }

  void mutate(std::string& text) {
    using namespace std::string_literals;
    static const std::vector<std::string> kPieces{"nan",     "inf",     "-1",
                                                  "1e308",   "1e-320",  "9999999999999999999",
                                                  ",",       ",,",      "\n",
                                                  "\r\n",    "\"",      "[",
                                                  "]",       "[[",      "=",
                                                  "{",       "}",       "#",
                                                  "'",       "\\u0000", "time_s",
                                                  ".",       "-",       "e",
                                                  "\t",      "\0"s,     "\xEF\xBB\xBF",
                                                  "\xff\xfe"};
    const std::size_t at = below(text.size()), length = std::min(text.size() - at, 1 + below(12));
    switch (below(6)) {
      case 0:
        text[at] = static_cast<char>(random_());
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, kPieces[below(kPieces.size())]);
        break;
      case 3:
        text.insert(below(text.size()), text.substr(at, length));
        break;
      case 4:
        text.resize(at);
        break;
      default:
        text.replace(at, length, kPieces[below(kPieces.size())]);
        break;
    }
  }

  std::mt19937 random_;
};

// 1 read, 0 refused; any other exception ends the test.
template <class Read>
int survives(Read&& read) {
  try {
    read();
    return 1;
  } catch (const ConfigError& error) {
    EXPECT_FALSE(error.where.empty());
    EXPECT_FALSE(error.what_is_wrong.empty());
    return 0;
  }
}

void expect_both_kinds(int read, int total) {
  EXPECT_GT(read, total / 100)
      << "nearly everything is refused: the mutations are too coarse to test anything";
  EXPECT_LT(read, total * 99 / 100)
      << "nearly everything is read: the mutations are too fine to test anything";
}

std::string shipped(const std::string& name) {
  return read_file(models_folder() / name);
}

TEST(FileFuzz, AMutatedModelIsReadOrRefused) {
  const std::string original = shipped("rehearsal.toml");
  Mutator mutated(1);
  int read = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::string text = mutated(original);
    read += survives([&] {
      const PlantModel model = parse_model(text, "m.toml");
      // What was read can be run.
      PlantState state = at_rest(model);
      for (int k = 0; k < 5; ++k) state = step(model, state, {.voltage = 5000.0}, Seconds(1e-3));
      EXPECT_TRUE(std::isfinite(state.motion.x)) << text;
    });
  }
  expect_both_kinds(read, 3000);
}

TEST(FileFuzz, ATableHeaderThatBeginsWrongIsRefusedAndDoesNotAbort) {
  expect_refusal(refusal([] { parse_model("[baseline]\n[.x]\n", "m.toml"); }), "m.toml:2", "");
}

TEST(FileFuzz, AMutatedRunIsReadOrRefused) {
  const ScratchFolder folder;
  folder.write("dataset.toml", "[[run]]\nname = \"a\"\nfile = \"a.csv\"\nweight_g = 50\n");
  std::string original = "# bench\ntime_s,voltage_V,displacement_mm,current_uA\n";
  for (int k = 0; k < 12; ++k) original += "0.0" + std::to_string(10 + k) + ",1000,0.25,0.5\n";
  Mutator mutated(2);
  int read = 0;
  for (int i = 0; i < 3000; ++i) {
    folder.write("a.csv", mutated(original));
    read += survives([&] {
      const Dataset dataset = read_dataset(folder.path(), Drive::Stack);
      const RecordedRun answer = simulate(PlantModel{}, dataset.runs.at(0));
      for (const double x : answer.displacement) EXPECT_TRUE(std::isfinite(x));
    });
  }
  expect_both_kinds(read, 3000);
}

TEST(FileFuzz, AMutatedDescriptionIsReadOrRefused) {
  const ScratchFolder folder;
  folder.write("a.csv", "time_s,voltage_V,displacement_mm\n0,0,0\n0.001,0,0\n");
  const std::string original =
      "title = \"ramp\"\nsensor_noise_mm = 0.010\n[[run]]\nname = \"a\"\nfile = \"a.csv\"\nweight_g = 50\n"
      "[[run]]\nname = \"b\"\nfile = \"a.csv\"\nexternal_force_N = 0.1\n";
  Mutator mutated(3);
  int read = 0;
  for (int i = 0; i < 2000; ++i) {
    folder.write("dataset.toml", mutated(original));
    read += survives([&] { read_dataset(folder.path(), Drive::Stack); });
  }
  expect_both_kinds(read, 2000);
}

}  // namespace
}  // namespace biopsy::sim
