// A file that is written piece by piece, and read where its writer was killed. Messages and cuts are drawn
// here, seeded; @mcap/core reads.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "robot/recorder/mcap_writer.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::recorder {
namespace {

const std::string kSchema =
    R"({"type":"object","properties":{"n":{"type":"integer"},"text":{"type":"string"}}})";

struct Pieces {
  std::string file;
  std::vector<std::size_t> ends;  // of each piece
  std::vector<int> messages;      // in it and those before
};

// Pieces of no message, of a few, and of more than a chunk holds.
Pieces drawn_pieces() {
  std::mt19937 random(61);
  McapWriter writer("test");
  const std::uint16_t a = writer.add_channel("/a", "a", kSchema), b = writer.add_channel("/b", "b", kSchema);
  Pieces pieces;
  int n = 0;
  for (int piece = 0; piece < 12; ++piece) {
    for (auto more = piece == 5 ? 3'000 : static_cast<int>(random() % 40); more > 0; --more, ++n)
      writer.add_message(random() % 2 ? a : b, static_cast<std::uint32_t>(n),
                         1'795'000'000'000'000'000U + random(),
                         fmt::format(R"({{"n":{},"text":"{}"}})", n, std::string(random() % 900, 'x')));
    pieces.file += writer.take();
    pieces.ends.push_back(pieces.file.size());
    pieces.messages.push_back(n);
  }
  pieces.file += writer.finish();
  return pieces;
}

// A line of answer for each length; without lengths one.
std::vector<nlohmann::json> recovered(const std::string& file, const std::vector<std::size_t>& lengths) {
  const ScratchFolder folder;
  folder.write("file.mcap", file);
  const std::string command =
      fmt::format("cd {} && node recover.mjs {} {} > {} 2>&1", (binary_dir() / "mcap_reader").string(),
                  (folder / "file.mcap").string(), fmt::join(lengths, " "), (folder / "told").string());
  EXPECT_EQ(std::system(command.c_str()), 0) << file_content(folder / "told");
  std::vector<nlohmann::json> answers;
  std::istringstream told(file_content(folder / "told"));
  for (std::string line; std::getline(told, line);) answers.push_back(nlohmann::json::parse(line));
  return answers;
}

TEST(McapCore, ReadsAFileWrittenInPieces) {
  if (!std::filesystem::exists(binary_dir() / "mcap_reader/node_modules"))
    GTEST_SKIP() << "without npm and its registry";
  const Pieces pieces = drawn_pieces();
  const auto answers = recovered(pieces.file, {});
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0]["messages"], pieces.messages.back());
  EXPECT_EQ(answers[0]["disorder"], nlohmann::json::array());
  EXPECT_TRUE(answers[0]["whole"]);
}

// Its summary too: every position in it counts from the file's beginning.
TEST(McapCore, ReadsByIndexAFileWrittenInPieces) {
  const std::filesystem::path reader = binary_dir() / "mcap_reader";
  if (!std::filesystem::exists(reader / "node_modules")) GTEST_SKIP() << "without npm and its registry";
  const ScratchFolder folder;
  folder.write("file.mcap", drawn_pieces().file);
  folder.write("layout.json",
               R"({"layout":{"direction":"row","first":"Plot!a","second":"Plot!b"},"configById":{
                 "Plot!a":{"paths":[{"value":"/a.n"},{"value":"/a.text"},{"value":"/a"}]},
                 "Plot!b":{"paths":[{"value":"/b.n"},{"value":"/b.text"}]}}})");
  const auto paths = [&](const char* layout) {
    return std::system(fmt::format("cd {} && node paths.mjs {} {} > {} 2>&1", reader.string(),
                                   (folder / layout).string(), (folder / "file.mcap").string(),
                                   (folder / "told").string())
                           .c_str());
  };
  EXPECT_EQ(paths("layout.json"), 0) << file_content(folder / "told");
  // And the check of a layout sees a path that leads nowhere.
  std::string wrong = file_content(folder / "layout.json");
  wrong.replace(wrong.find("/b.text"), 7, "/b.tax");
  folder.write("wrong.json", wrong);
  EXPECT_NE(paths("wrong.json"), 0);
}

TEST(McapCore, FindsEveryWholePieceWhereverAFileEnds) {
  if (!std::filesystem::exists(binary_dir() / "mcap_reader/node_modules"))
    GTEST_SKIP() << "without npm and its registry";
  const Pieces pieces = drawn_pieces();
  std::vector<std::size_t> cuts(pieces.ends);
  std::mt19937 random(62);
  for (int n = 0; n < 40; ++n) cuts.push_back(random() % pieces.file.size());
  const auto answers = recovered(pieces.file, cuts);
  ASSERT_EQ(answers.size(), cuts.size());
  for (std::size_t n = 0; n < cuts.size(); ++n) {
    const auto whole = std::ranges::upper_bound(pieces.ends, cuts[n]) - pieces.ends.begin();
    const int at_least = whole == 0 ? 0 : pieces.messages[static_cast<std::size_t>(whole - 1)];
    EXPECT_GE(answers[n]["messages"].get<int>(), at_least) << "cut at " << cuts[n];
    EXPECT_LE(answers[n]["messages"].get<int>(), pieces.messages.back());
    EXPECT_EQ(answers[n]["disorder"], nlohmann::json::array()) << "cut at " << cuts[n];
  }
}

}  // namespace
}  // namespace biopsy::recorder
