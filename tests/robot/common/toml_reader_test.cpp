#include "robot/common/files/toml_reader.hpp"

#include <gtest/gtest.h>

#include "robot/common/config_error.hpp"

namespace biopsy {
namespace {

struct Read {
  double number = 0.0, noted = 0.0;
  std::uint32_t count = 0;
  std::string text;
  std::vector<double> list;
  std::vector<std::string> names, rows;
  bool flag = false;
};

Read read_all(TomlTable& root) {
  Read out;
  out.number = root.number("number", 0.0, 10.0, "mm");
  if (root.has("count")) out.count = root.whole_number("count", 100);
  if (root.has("flag")) out.flag = root.flag("flag");
  if (root.has("list")) out.list = root.numbers("list", -1.0, 1.0);
  if (root.has("names")) out.names = root.texts("names");
  if (root.has("inner")) {
    TomlTable inner = root.table("inner");
    out.text = inner.text("text");
    if (inner.has("noted")) out.noted = inner.number("noted", 0.0, 1.0);
  }
  for (TomlTable& row : root.tables("row")) out.rows.push_back(row.text("name"));
  root.ignore("remark");
  return out;
}

TEST(TomlTable, ReadsEachKindOfEntry) {
  const Read read = parse_toml(
      "number = 3\ncount = 7\nflag = true\nlist = [0.5, -1]\nnames = ['a', 'b']\nremark = 1\n"
      "[inner]\ntext = 'words'\nnoted = { value = 0.5, std = 0.1, source = 'fit' }\n"
      "[[row]]\nname = 'x'\n[[row]]\nname = 'y'\n",
      "t.toml", read_all);
  EXPECT_EQ(read.number, 3.0);
  EXPECT_EQ(read.count, 7U);
  EXPECT_TRUE(read.flag);
  EXPECT_EQ(read.list, (std::vector<double>{0.5, -1}));
  EXPECT_EQ(read.names, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(read.text, "words");
  EXPECT_EQ(read.noted, 0.5);
  EXPECT_EQ(read.rows, (std::vector<std::string>{"x", "y"}));
}

TEST(TomlTable, RefusesWhatIsNotAskedForOrNotInRangeWithItsLine) {
  const struct {
    const char *text, *place, *what;
  } kCases[] = {
      {"", "t.toml:1", "`number` is missing"},
      {"number = 'a'", "t.toml:1", "`number` is not a finite number"},
      {"number = nan", "t.toml:1", "`number` is not a finite number"},
      {"number = true", "t.toml:1", "`number` is not a finite number"},
      {"\nnumber = 11", "t.toml:2", "`number` = 11 mm is outside [0, 10]"},
      {"number = { std = 1 }", "t.toml:1", "`number` is a table without `value`"},
      {"number = { value = 1, sdt = 1 }", "t.toml:1", "unknown name `sdt`"},
      {"number = 1\ncount = 1.5", "t.toml:2", "`count` is not a whole number"},
      {"number = 1\ncount = 101", "t.toml:2", "outside [0, 100]"},
      {"number = 1\nflag = 1", "t.toml:2", "`flag` is neither true nor false"},
      {"number = 1\nlist = [0, 2]", "t.toml:2", "`list` = 2 is outside [-1, 1]"},
      {"number = 1\nlist = 0", "t.toml:2", "`list` is not a list of numbers"},
      {"number = 1\nnames = ['a', 1]", "t.toml:2", "`names` is not a list of texts"},
      {"number = 1\ninner = 1", "t.toml:2", "`inner` is not a table"},
      {"number = 1\n[inner]\ntext = 1", "t.toml:3", "`text` is not a text"},
      {"number = 1\n[inner]\ntext = \"a\\u0000b\"", "t.toml:3", "`text` is not a text"},
      {"number = 1\nrow = 1", "t.toml:2", "`row` is not a list of tables"},
      {"number = 1\nnumbr = 1", "t.toml:2", "unknown name `numbr`"},
      {"number = 1\n[inner]\ntext = 'a'\ntxt = 'b'", "t.toml:4", "unknown name `txt`"},
      {"number = 1\n[[row]]\nname = 'a'\n[[row]]\nname = 'b'\nnmae = 'c'", "t.toml:6", "unknown name `nmae`"},
      {"number = ", "t.toml:1", ""},
      {"[.x]", "t.toml:1", ""},
      {"number = \xC6\x8A", "t.toml:1", ""}};
  for (const auto& [text, place, what] : kCases) {
    try {
      parse_toml(text, "t.toml", read_all);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const ConfigError& error) {
      EXPECT_EQ(error.where, place) << text;
      EXPECT_NE(error.what_is_wrong.find(what), std::string::npos) << error.what_is_wrong;
      EXPECT_FALSE(error.remedy.empty()) << text;
    }
  }
}

TEST(Quoted, IsReadBackAsItWas) {
  const std::string text = "a \"b\" \\ \n\t\x7f ü";
  EXPECT_EQ(parse_toml("t = " + quoted(text), "t.toml", [](TomlTable& root) { return root.text("t"); }),
            text);
}

}  // namespace
}  // namespace biopsy
