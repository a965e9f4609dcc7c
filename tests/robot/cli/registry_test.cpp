// What holds of every command because one registry holds them all: help, options, examples, outputs, JSON,
// reference and completion.
#include <algorithm>
#include <set>

#include "robot/cli/help.hpp"
#include "tests/robot/cli/command.hpp"

namespace biopsy::cli_tests {
namespace {

namespace fs = std::filesystem;
using robot::Command, robot::CommandLine, robot::OptionFacts;

bool is_group(const CommandLine::Entry& entry) {
  return !entry.run;
}

TEST(Registry, ExplainsEveryCommandBeginningWithItsOwnName) {
  const CommandLine line;
  EXPECT_GE(line.entries.size(), 24U);
  for (const CommandLine::Entry& entry : line.entries) {
    const Command& command = *entry.command;
    const Outcome help = standard_output(command.name + " --help");
    EXPECT_EQ(help.code, 0) << command.name;
    EXPECT_TRUE(help.text.starts_with("biopsy " + command.name + " ") ||
                help.text.starts_with("biopsy " + command.name + "\n"))
        << help.text;
    EXPECT_EQ(help.text, robot::help_of(line, command.name));
    EXPECT_NE(help.text.find(command.summary), std::string::npos);
    EXPECT_EQ(help.text.find("]("), std::string::npos) << "a link as Markdown: " << help.text;
    if (is_group(entry)) continue;
    EXPECT_NE(help.text.find("Example:\n  biopsy " + command.name), std::string::npos) << help.text;
    EXPECT_FALSE(command.exit_codes.empty()) << command.name;
    for (const OptionFacts& option : robot::options_of(*entry.app)) {
      EXPECT_NE(help.text.find(option.name), std::string::npos) << option.name;
      EXPECT_GT(option.meaning.size(), 8U) << command.name << " " << option.name;
    }
  }
}

// The words of a line, with '...' and "..." as one word.
std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

TEST(Registry, HasExamplesThatTheParserAccepts) {
  for (const Command& command : robot::registry()) {
    std::vector<std::string> examples = command.examples;
    examples.insert(examples.end(), command.long_examples.begin(), command.long_examples.end());
    for (const std::string& example : examples) {
      EXPECT_TRUE(example.starts_with("biopsy " + command.name)) << example;
      CommandLine line;
      std::vector<std::string> words = words_of(example);
      std::reverse(words.begin(), words.end());  // as CLI11 takes them
      words.pop_back();
      EXPECT_NO_THROW(line.app->parse(words)) << example;
    }
  }
}

TEST(Registry, DeclaresEveryFileThatARunWrites) {
  const ScratchFolder folder;
  const auto written = [&](const std::string& words, const std::string& command) {
    const fs::path out = folder / command;
    const Outcome outcome = biopsy(words + " --out " + out.string());
    EXPECT_EQ(outcome.code, 0) << outcome.text;
    const auto& all = robot::registry();
    const auto entry =
        std::find_if(all.begin(), all.end(), [&](const Command& one) { return one.name == command; });
    for (const auto& file : fs::directory_iterator(out)) {
      const std::string name = file.path().filename().string();
      if (name == ".biopsy-run") continue;
      EXPECT_TRUE(std::any_of(entry->outputs.begin(), entry->outputs.end(),
                              [&](const robot::OutputFile& output) {
                                const std::size_t star = output.name.find('*');
                                return star == std::string::npos
                                           ? output.name == name
                                           : name.starts_with(output.name.substr(0, star)) &&
                                                 name.ends_with(output.name.substr(star + 1));
                              }))
          << command << " writes " << name;
    }
  };
  const std::string examples = (kSource / "docs/examples").string(),
                    models = (kSource / "sim/models").string();
  written("dry-run liver", "dry-run");
  written("plan gap", "plan");
  written("simulate " + examples + "/recorded --model " + models + "/baseline.toml", "simulate");
  written("identify " + examples + "/current", "identify");
  written("reproduce 6", "reproduce");
  written("characterise dc --bench", "characterise");
  const std::string image = (folder / "dry-run/planning").string();
  written("check --before " + image + " --after " + (folder / "dry-run/images/stage-1").string() +
              " --entry -4.396,33.092,51.854 --axis -0.936,0.036,-0.349",
          "check");
}

// A later run replaces what an earlier one of any command left, and nothing else.
TEST(Registry, ClearsOnlyDeclaredOutputs) {
  const ScratchFolder folder;
  const std::string out = " --out " + (folder / "out").string();
  ASSERT_EQ(biopsy("characterise dc --bench" + out).code, 0);
  ASSERT_TRUE(fs::exists(folder / "out/dataset.toml"));
  folder.write("out/notes.md", "mine");
  folder.write("out/procedure.log.sqlite", "a log is never cleared");
  ASSERT_EQ(biopsy("plan gap" + out).code, 0);
  EXPECT_FALSE(fs::exists(folder / "out/dataset.toml"));
  EXPECT_EQ(file_content(folder / "out/notes.md"), "mine");
  EXPECT_TRUE(fs::exists(folder / "out/procedure.log.sqlite"));
}

TEST(Registry, PrintsEveryResultAsJsonAndNothingElse) {
  const ScratchFolder folder;
  const auto path = [&](const std::string& name) { return (folder / name).string(); };
  const std::string examples = (kSource / "docs/examples").string(),
                    models = (kSource / "sim/models").string(), log = path("log");
  const std::vector<std::tuple<std::string, std::string, std::string>> runs{
      {"dry-run gap --out " + path("dry"), "outcome", "dry-run"},
      {"plan gap --out " + path("plan"), "outcome", "plan"},
      {"check --before " + path("dry/planning") + " --after " + path("dry/images/stage-1") +
           " --entry -4.396,33.092,51.854 --axis -0.936,0.036,-0.349",
       "verdict", "check"},
      {"campaign gap --faults " + examples + "/faults.toml --runs 1 --out " + path("campaign"), "entries",
       "campaign"},
      {"image " + path("dry/planning") + " --png " + path("png"), "image", "image"},
      {"simulate " + examples + "/recorded --model " + models + "/baseline.toml --out " + path("sim"), "runs",
       "simulate"},
      {"effects stribeck_friction", "equation", "effects"},
      {"characterise dc --bench --out " + path("bench"), "runs", "characterise"},
      {"characterise --dry-run", "plan", "characterise"},
      {"keys init --keys " + path("keys"), "until", "keys init"},
      {"keys check --keys " + path("keys"), "good", "keys check"},
      {"calibrate-tip --before " + path("dry/planning") + " --after " + path("dry/images/stage-1") +
           " --entry -4.396,33.092,51.854 --axis -0.936,0.036,-0.349 --depth 2.55 --needle n --sequence s "
           "--key " +
           path("keys/commissioning/signing_key.pem") + " --out " + path("tip"),
       "tip_offset_mm", "calibrate-tip"},
      {"up gap --prepare --keys " + path("keys") + " --domain 201 --out " + path("up"), "prepared", "up"},
      {"commission --device sim --yes --key " + path("keys/commissioning/signing_key.pem") + " --out " +
           path("commissioned"),
       "steps", "commission"},
      {"commission --dry-run", "steps", "commission"},
      {"reproduce 2 --out " + path("paper"), "rows", "reproduce"},
      {"identify " + examples + "/current --out " + path("current"), "values", "identify"},
      {"help", "", "help"}};
  std::set<std::string> seen;
  for (const auto& [words, field, command] : runs) {
    const Outcome outcome = standard_output(words + " --json");
    EXPECT_EQ(outcome.code, 0) << words << "\n" << outcome.text;
    const nlohmann::json json = nlohmann::json::parse(outcome.text, nullptr, false);
    EXPECT_FALSE(json.is_discarded()) << words << "\n" << outcome.text;
    if (!field.empty()) {
      EXPECT_TRUE(json.contains(field)) << words << "\n" << outcome.text;
    }
    seen.insert(command);
  }
  const std::string printed = standard_output("plan gap --json --out " + path("same")).text;
  EXPECT_EQ(printed, file_content(folder / "same/report.json"));
  // The rest prints what its JSON file holds, or is shown in tests of its own (log, confirm), and takes
  // minutes here.
  const std::set<std::string> elsewhere{"gap",     "calibrate", "design",     "tune",      "safety-case",
                                        "confirm", "log show",  "log verify", "log export"};
  for (const Command& command : robot::registry()) {
    const bool has_json = command.declare && command.name != "completion bash";
    EXPECT_EQ(has_json, !command.json.empty()) << command.name;
    EXPECT_TRUE(!has_json || seen.contains(command.name) || elsewhere.contains(command.name)) << command.name;
  }
}

TEST(Registry, IsWhatTheReferencePrints) {
  const std::string reference = file_content(kSource / "docs/reference/commands.md"),
                    begin = "<!-- commands -->\n", end = "<!-- end of commands -->";
  const std::size_t from = reference.find(begin), to = reference.find(end);
  ASSERT_NE(from, std::string::npos);
  ASSERT_NE(to, std::string::npos);
  EXPECT_TRUE(reference.substr(from + begin.size(), to - from - begin.size()) ==
              robot::reference_markdown(CommandLine()))
      << "docs/reference/commands.md is not what the program prints: ./dev docs renews it";
  EXPECT_EQ(standard_output("help --markdown").text, robot::reference_markdown(CommandLine()));
}

// What bash offers for the last of `words`.
std::set<std::string> completed(const ScratchFolder& folder, const std::vector<std::string>& words) {
  folder.write("complete.sh", standard_output("completion bash").text);
  std::string list;
  for (const std::string& word : words) list += " '" + word + "'";
  const Outcome outcome =
      shell("bash -c \"source '" + (folder / "complete.sh").string() + "'; COMP_WORDS=(biopsy" + list +
            "); COMP_CWORD=" + std::to_string(words.size()) +
            "; _biopsy; printf '%s\\n' \\\"\\${COMPREPLY[@]}\\\"\" 2>&1");
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  std::istringstream stream(outcome.text);
  std::set<std::string> offered;
  for (std::string word; stream >> word;) offered.insert(word);
  return offered;
}

TEST(Registry, CompletesCommandsOptionsAndChoicesInBash) {
  using Words = std::set<std::string>;
  const ScratchFolder folder;
  EXPECT_EQ(completed(folder, {"re"}), (Words{"reproduce"}));
  EXPECT_EQ(completed(folder, {"log", ""}), (Words{"show", "verify", "export", "--help"}));
  EXPECT_EQ(completed(folder, {"keys", "in"}), (Words{"init"}));
  EXPECT_EQ(completed(folder, {"gap", "data", "--wi"}), (Words{"--window"}));
  EXPECT_EQ(completed(folder, {"log", "export", "l", "--c"}), (Words{"--csv"}));
  EXPECT_EQ(completed(folder, {"up", "gap", "--device", "n"}), (Words{"nidaqmx"}));
  EXPECT_EQ(completed(folder, {"gap", "--log-level", "w"}), (Words{"warning"}));
  EXPECT_EQ(completed(folder, {"gap", "docs/ex"}), Words()) << "left to bash, which offers files";
  const CommandLine line;
  for (const CommandLine::Entry& entry : line.entries) {
    if (is_group(entry)) continue;
    std::vector<std::string> words = words_of(entry.command->name);
    words.emplace_back("--");
    Words all{"--help", "--log-level", "--log-format"};
    for (const OptionFacts& option : robot::options_of(*entry.app))
      if (option.name.starts_with("--")) all.insert(option.name);
    EXPECT_EQ(completed(folder, words), all) << entry.command->name;
  }
}

}  // namespace
}  // namespace biopsy::cli_tests
