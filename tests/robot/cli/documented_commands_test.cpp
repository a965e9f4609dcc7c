// Every command in the documents runs as written, every link resolves, and they describe every case entry,
// effect, hazard and report field (commands and options: registry_test.cpp).
#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <set>
#include <vector>

#include "planner/imaging/depth_check/depth_verdict.hpp"
#include "robot/msg/fixed_messages.hpp"
#include "safety/types/hazards.hpp"
#include "safety/types/transitions.hpp"
#include "tests/robot/cli/command.hpp"
#include "tests/robot/cli/documented_fields.hpp"
#include "tests/robot/live/steady_host.hpp"

namespace biopsy::cli_tests {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> documents() {
  std::vector<fs::path> files{kSource / "README.md"};
  for (const auto& entry : fs::recursive_directory_iterator(kSource / "docs"))
    if (entry.path().extension() == ".md") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::string name_of(const fs::path& document) {
  return fs::relative(document, kSource).string();
}

struct Line {
  int number;
  std::string fence;  // language of the block it stands in; empty outside of blocks
  std::string text;
};

std::vector<Line> lines_of(const fs::path& document) {
  std::vector<Line> lines;
  std::ifstream stream(document);
  std::string fence;
  int number = 0;
  for (std::string text; std::getline(stream, text);) {
    ++number;
    if (!text.starts_with("```")) {
      lines.push_back({number, fence, text});
    } else if (!fence.empty()) {
      fence.clear();
    } else {
      fence = text.substr(3);
      EXPECT_TRUE((std::set<std::string>{"sh", "toml", "csv", "json", "text"}.contains(fence)))
          << name_of(document) << ":" << number << ": a block in an unknown language: \"" << fence << "\"";
      if (fence.empty()) fence = "?";
    }
  }
  EXPECT_TRUE(fence.empty()) << name_of(document) << " ends inside a block";
  return lines;
}

std::string prose_of(const std::string& document) {
  return file_content(kSource / "docs" / document);
}

// Each match of `pattern` in `text`: its first group.
std::set<std::string> found_in(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::set<std::string> found;
  for (std::sregex_iterator match(text.begin(), text.end(), regex), end; match != end; ++match)
    found.insert((*match)[1]);
  return found;
}

// A command ends with "# exits N" where its answer is not 0.
int promised_code(const std::string& command) {
  std::smatch match;
  return std::regex_search(command, match, std::regex(R"(# exits (\d+)$)")) ? std::stoi(match[1]) : 0;
}

class Document : public testing::TestWithParam<fs::path> {
 protected:
  // A copy of the examples and the models, as they lie in the repository.
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "docs/reference");  // biopsy effects --markdown writes there
    fs::create_directories(folder_ / "sim");
    fs::copy(kSource / "docs/examples", folder_ / "docs/examples", fs::copy_options::recursive);
    fs::copy(kSource / "sim/models", folder_ / "sim/models", fs::copy_options::recursive);
    came_from_ = fs::current_path();
    setenv("XDG_CONFIG_HOME", (folder_ / "config").c_str(), 1);  // no test touches a user's own keys
    fs::current_path(folder_);
  }
  void TearDown() override {
    fs::current_path(came_from_);
    fs::remove_all(folder_);
  }

  const fs::path folder_ = fs::temp_directory_path() / ("biopsy-documented-" + GetParam().stem().string());
  fs::path came_from_;
};

std::set<std::string> dev_verbs() {
  const std::string help = file_content(kSource / "dev");
  return found_in(help, R"(\n  ([a-z-]+)\)  # )");
}

TEST_P(Document, EveryCommandRunsAsWritten) {
  const std::set<std::string> verbs = dev_verbs();
  ASSERT_TRUE(verbs.contains("run"));
  for (const Line& line : lines_of(GetParam())) {
    const std::string where = name_of(GetParam()) + ":" + std::to_string(line.number) + ": " + line.text;
    const bool ours = line.text.starts_with("biopsy "), dev_verb = line.text.starts_with("./dev "),
               copy = line.text.starts_with("cp ");
    if (line.fence != "sh") {
      EXPECT_FALSE((ours || dev_verb) && !line.fence.empty()) << where << ": a command outside of a sh block";
      continue;
    }
    ASSERT_TRUE(ours || dev_verb || copy) << where << ": neither a command of the program nor of ./dev";
    if (copy) {
      std::istringstream words(line.text.substr(3));
      std::string from, to;
      words >> from >> to;
      fs::copy_file(from, to);
    } else if (ours) {
      const std::string words = line.text.substr(7, line.text.find(" # ") - 7);
      Outcome answer;
      bool here = true;
      if (words.find("--live") == std::string::npos)
        answer = biopsy(words);
      else  // in real time: a machine that stalls stops a procedure
        here = live_tests::on_a_steady_host([&] {
          answer = biopsy(words);
          return answer.code == 3 && promised_code(line.text) != 3
                     ? "the procedure was stopped\n" + answer.text
                     : std::string();
        });
      if (!here) return;
      ASSERT_EQ(answer.code, promised_code(line.text)) << where << "\n" << answer.text;
    } else {  // not run: some of them run this test
      EXPECT_TRUE(verbs.contains(line.text.substr(6, line.text.find(' ', 6) - 6)))
          << where << ": no such verb";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, Document, testing::ValuesIn(documents()), [](const auto& given) {
  return std::regex_replace(fs::relative(given.param, kSource).replace_extension().string(),
                            std::regex("\\W"), "_");
});

// How GitHub names the anchor of a heading.
std::string anchor_of(const std::string& heading) {
  std::string anchor;
  for (const char letter : heading)
    if (std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '-' || letter == '_')
      anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    else if (letter == ' ')
      anchor += '-';
  return anchor;
}

std::set<std::string> anchors_of(const fs::path& document) {
  std::set<std::string> anchors;
  for (const Line& line : lines_of(document))
    if (line.fence.empty() && line.text.starts_with("#"))
      anchors.insert(anchor_of(line.text.substr(line.text.find(' ') + 1)));
  return anchors;
}

TEST(Documents, HaveNoBrokenLink) {
  int links = 0;
  for (const fs::path& document : documents())
    for (const std::string& link : found_in(file_content(document), R"(\]\(([^)]+)\))")) {
      if (link.starts_with("http")) continue;
      ++links;
      const std::string file = link.substr(0, link.find('#'));
      const fs::path target = file.empty() ? document : document.parent_path() / file;
      ASSERT_TRUE(fs::exists(target)) << name_of(document) << " links to " << link;
      if (link.find('#') == std::string::npos) continue;
      EXPECT_TRUE(anchors_of(target).contains(link.substr(link.find('#') + 1)))
          << name_of(document) << " links to " << link;
    }
  EXPECT_GT(links, 20);
}

TEST(Documents, EachIsLinkedFromTheReadme) {
  const std::string readme = file_content(kSource / "README.md");
  for (const fs::path& document : documents())
    if (document.filename() != "README.md") {
      EXPECT_NE(readme.find("(" + name_of(document) + ")"), std::string::npos) << name_of(document);
    }
}

TEST(Documents, DescribeEveryEntryOfACaseFile) {
  const std::string reference = prose_of("reference/commands.md");
  const auto entries =
      found_in(file_content(kSource / "robot/procedure/case/case.cpp"),
               R"rx((?:has|text|number|numbers|flag|table|tables|ras_point)\((?:table, )?"(\w+)")rx");
  EXPECT_GT(entries.size(), 20U);
  for (const std::string& entry : entries) EXPECT_TRUE(mentions(reference, entry)) << entry;
}

TEST(Documents, PrintTheExamplesAsTheyAre) {
  const std::string reference = prose_of("reference/commands.md");
  for (const char* example : {"case.toml", "fiducials.csv"})
    EXPECT_NE(reference.find(file_content(kSource / "docs/examples" / example)), std::string::npos)
        << example;
}

// The line of a table whose first cell is `name`.
std::string row_of(const std::string& text, const std::string& name) {
  const std::size_t start = text.find("\n| " + name + " |");
  return start == std::string::npos ? "" : text.substr(start + 1, text.find('\n', start + 1) - start - 1);
}

// The part of a page under the heading `name`.
std::string section_of(const std::string& text, const std::string& name) {
  const std::size_t start = text.find("\n## " + name + "\n");
  return start == std::string::npos ? "" : text.substr(start, text.find("\n## ", start + 1) - start);
}

// Read off the sources: an effect that the library forgot is found here.
TEST(Documents, DescribeEveryEffectWithItsParametersAndTheirRanges) {
  const std::string page = prose_of("reference/effects.md");
  const std::regex parameter(R"rx("(\w+)",\s*&\w+::\w+,\s*[-\d.e]+,\s*([-\d.e]+),\s*([-\d.e]+))rx");
  int parameters = 0;
  for (const auto& file : fs::recursive_directory_iterator(kSource / "sim/effects")) {
    const std::string name = file.path().stem().string();
    if (file.is_directory() || name.starts_with("effect")) continue;
    const std::string source = file_content(file.path());
    const std::string section = section_of(page, name);
    EXPECT_FALSE(section.empty()) << name << " is not in docs/reference/effects.md";
    for (std::sregex_iterator match(source.begin(), source.end(), parameter), end; match != end;
         ++match, ++parameters) {
      const std::string row = row_of(section, "`" + (*match)[1].str() + "`"),
                        range = fmt::format("| {} to {} |", std::stod((*match)[2]), std::stod((*match)[3]));
      EXPECT_NE(row.find(range), std::string::npos)
          << name << ", " << (*match)[1] << ": " << range << " is not in \"" << row << "\"";
    }
  }
  EXPECT_GT(parameters, 40);
}

TEST(Documents, PrintTheLibraryOfEffectsAsTheProgramDoes) {
  const Outcome answer = biopsy("effects --markdown");
  EXPECT_EQ(answer.code, 0);
  EXPECT_TRUE(answer.text == prose_of("reference/effects.md"))
      << "docs/reference/effects.md is not what the program prints; renew "
         "it: biopsy effects --markdown > docs/reference/effects.md";
}

TEST(Documents, DescribeTheThresholdsOfTheDepthCheck) {
  const std::string page = prose_of("explanation/depth-check.md");
  const imaging::DepthCheckSettings check;
  const imaging::SearchReach reach;
  const auto expect_row = [&](const std::string& name, const std::string& cell) {
    EXPECT_TRUE(row_of(page, name).ends_with("| " + cell + " |")) << name << " " << cell;
  };
  const auto number = [](double value) {
    std::ostringstream text;
    text << value;
    return text.str();
  };
  const auto allowance = [&](const imaging::Allowance& of, const std::string& unit) {
    return number(of.tolerance) + unit + " | " + number(of.limit) + unit;
  };
  expect_row("depth", allowance(check.depth_mm, " mm"));
  expect_row("tip beside the planned axis", allowance(check.lateral_mm, " mm"));
  expect_row("angle to the planned axis", allowance(check.angle_deg, " degrees"));
  expect_row("confidence of an accept", number(100.0 * check.confidence) + " %");
  expect_row("confidence of a reject", number(100.0 * check.missed_certainly) + " %");
  expect_row("correlation after registration, at least", number(check.registration_min));
  expect_row("evidence (lost signal over its standard deviation), at least", number(check.evidence_min));
  expect_row("share of the signal lost in the void, at least", number(check.loss_min));
  expect_row("no needle where less than this share is lost for certain", number(check.needle_loss));
  expect_row("searched beside the axis, at the entry", number(reach.beside_mm) + " mm");
  expect_row("searched against the axis", number(reach.tilt_deg) + " degrees");
}

TEST(Documents, DescribeEveryStateAndTransition) {
  const std::string safety_page = prose_of("reference/supervisor.md");
  for (const safety::Transition& way : safety::kTransitions) {
    const std::string row = row_of(safety_page, std::string(safety::name_of(way.from)));
    const std::string cell =
        std::string(safety::name_of(way.event)) + " → " + std::string(safety::name_of(way.to));
    EXPECT_NE(row.find(cell), std::string::npos) << safety::name_of(way.from) << ": " << cell;
  }
}

TEST(Documents, DescribeEveryFieldOfTheReports) {
  const ScratchFolder folder;
  const std::string reference = prose_of("reference/commands.md"), run = (folder / "run").string(),
                    image = run + "/planning";
  EXPECT_NE(biopsy("dry-run gap --out " + run).code, 2);
  const Outcome checked =
      biopsy("check --before " + image + " --after " + image +
             "  --entry -4.4,33.1,51.9 --axis -0.94,0.04,-0.35 --out " + (folder / "check").string());
  ASSERT_EQ(checked.code, 0) << checked.text;
  expect_documented(json_of(folder / "run/report.json"), reference);
  expect_documented(json_of(folder / "check/check.json"), reference);
  std::string header = file_content(folder / "run/run.csv");
  header = header.substr(0, header.find('\n'));
  for (const std::string& column : found_in(header + ",", "([^,]+),"))
    EXPECT_TRUE(mentions(reference, column)) << column;
}

}  // namespace
}  // namespace biopsy::cli_tests
