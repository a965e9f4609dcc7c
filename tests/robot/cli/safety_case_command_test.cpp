// The risk management file of this build: what stands in it, what refuses it, and the page that is printed
// from it.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "robot/cli/safety_case/risk_files.hpp"
#include "robot/cli/safety_case/safety_case_files.hpp"
#include "robot/common/config_error.hpp"
#include "robot/report/safety_case/gaps.hpp"
#include "robot/report/safety_case/risk_checks.hpp"
#include "tests/robot/cli/command.hpp"

namespace biopsy::cli_tests {
namespace {

namespace fs = std::filesystem;
using safety_case::SafetyCase, safety_case::Soup;

SafetyCase shipped_case() {
  return robot::read_safety_case(kSource / "safety/case");
}

TEST(RiskFile, OfThisBuildHasNoGap) {
  const SafetyCase safety_case = shipped_case();
  for (const safety_case::Gap& gap : safety_case::gaps_in_argument(safety_case))
    ADD_FAILURE() << gap.where << ": " << gap.what;
  EXPECT_GE(safety_case.risk.risks.size(), safety_case.hazards.size());
}

TEST(RiskFile, ShowsWhatIsNotAcceptableFirst) {
  const SafetyCase safety_case = shipped_case();
  const std::string page = standard_output("safety-case --markdown").text;
  const std::string first = page.substr(0, page.find("## Risks after control"));
  for (const safety_case::Risk* risk : safety_case::open_risks(safety_case.risk))
    EXPECT_NE(first.find("| " + risk->id + " |"), std::string::npos) << risk->id;
}

TEST(RiskFile, IsWhatTheReferencePrints) {
  const Outcome printed = standard_output("safety-case --markdown");
  EXPECT_EQ(printed.code, 0);
  EXPECT_TRUE(printed.text == file_content(kSource / "docs/reference/risk-management.md"))
      << "docs/reference/risk-management.md is not what the program prints: ./dev docs renews it";
}

// docs/reference/safety-case: what a whole run on two cores wrote. It belongs to the code that it names; a
// change of what must hold makes it another case.
TEST(FinishedCase, InTheDocumentsIsWholeWithoutGapAndOfTodaysArgument) {
  const fs::path folder = kSource / "docs/reference/safety-case";
  const auto stored = nlohmann::json::parse(file_content(folder / "safety-case.json"));
  const std::string renew =
      "run ./dev safety-case and copy report.html and safety-case.json to " + folder.string();
  EXPECT_TRUE(stored["passed"].get<bool>() && !stored["quick"].get<bool>() && stored["gaps"].empty());
  for (const auto& bar : stored["bars"]) EXPECT_TRUE(bar["met"].get<bool>()) << bar["name"];
  for (const auto& evidence : stored["evidence"]) EXPECT_EQ(evidence["code"], stored["build"]["code"]);
  const std::string commit = stored["build"]["commit"];
  EXPECT_EQ(commit.find_first_not_of("0123456789abcdef"), std::string::npos) << commit;
  const std::string page = file_content(folder / "report.html");
  EXPECT_NE(page.find(commit.substr(0, 12)), std::string::npos);

  const SafetyCase safety_case = shipped_case();
  std::set<std::string> now, then, bars_now, bars_then;
  for (const auto& hazard : safety_case.hazards) now.insert(hazard.id);
  for (const auto& requirement : safety_case.requirements) now.insert(requirement.id + requirement.text);
  for (const auto& hazard : stored["hazards"]) then.insert(hazard["id"]);
  for (const auto& requirement : stored["requirements"])
    then.insert(requirement["id"].get<std::string>() + requirement["text"].get<std::string>());
  EXPECT_EQ(now, then) << renew;
  for (const auto& source : safety_case.sources)
    for (const auto& criterion : source.criteria) bars_now.insert(criterion.name);
  for (const auto& bar : stored["bars"]) bars_then.insert(bar["name"]);
  EXPECT_EQ(bars_now, bars_then) << renew;
}

// The shipped files with one text replaced in one of them.
class RiskFileDamage : public testing::Test {
 protected:
  std::string refusal(const std::string& file, const std::string& from, const std::string& to) {
    for (const char* name : {"risk.toml", "software.toml", "threats.toml", "scenarios.toml"}) {
      std::string text = file_content(kSource / "safety/case" / name);
      if (name == file) {
        const std::size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from << " is not in " << file;
        if (at != std::string::npos) text.replace(at, from.size(), to);
      }
      folder_.write(name, text);
    }
    try {
      robot::read_risk_file(folder_ / "");
    } catch (const ConfigError& error) {
      EXPECT_NE(error.where.find(file + ":"), std::string::npos) << error.where;
      return error.what_is_wrong;
    }
    return "none";
  }

 private:
  ScratchFolder folder_;
};

TEST_F(RiskFileDamage, IsRefusedWithFileAndLine) {
  EXPECT_EQ(refusal("risk.toml", "", ""), "none");
  const auto expect = [&](const char* file, const char* from, const char* to, const char* what) {
    const std::string refused = refusal(file, from, to);
    EXPECT_NE(refused.find(what), std::string::npos) << from << " -> " << to << ": " << refused;
  };
  expect("risk.toml", "severity = 5\n", "severity = 6\n", "outside");
  expect("risk.toml", "severity = 5\n", "severity = 0\n", "outside");
  expect("risk.toml", "before = 4\n", "before = 3.5\n", "no whole number");
  expect("risk.toml", "after = 2\n", "after = -1\n", "outside");
  expect("risk.toml", "\nharm = ", "\nharmm = ", "`harm` is missing");
  expect("risk.toml", "after = 2\n", "after = 2\nlikelihood = 2\n", "unknown name `likelihood`");
  expect("risk.toml", "kind = \"protective\"", "kind = \"hopeful\"", "hopeful");
  expect("risk.toml", "basis = \"measured\"", "basis = \"felt\"", "felt");
  expect("risk.toml", "residual = \"tolerable\"", "residual = \"fine\"", "fine");
  expect("risk.toml", "severity_5 = [\"tolerable\",", "severity_5 = [\"acceptable\", \"tolerable\",",
         "one entry");
  expect("risk.toml", "severity_4 = [\"acceptable\"", "severity_4 = [\"not acceptable, open\"",
         "more kindly");
  expect("software.toml", "safety_class = \"C\"", "safety_class = \"D\"", "D");
  expect("software.toml", "[[soup]]", "[[soop]]", "unknown name `soop`");
  expect("threats.toml", "open = true", "open = 1", "open");
  expect("scenarios.toml", "user = ", "users = ", "`user` is missing");
}

// What stands in the folder of `path` or is `path` itself.
bool covers(const std::string& folder, const fs::path& path) {
  const std::string relative = fs::relative(path, kSource).string();
  return relative == folder || relative.starts_with(folder + "/");
}

TEST(SoftwareItems, HoldEverySourceFolderOnce) {
  const SafetyCase safety_case = shipped_case();
  std::set<fs::path> folders;
  for (const char* top : {"safety", "planner", "drivers", "sim"}) folders.insert(kSource / top);
  for (const auto& entry : fs::directory_iterator(kSource / "robot"))
    if (entry.is_directory()) folders.insert(entry.path());
  for (const fs::path& folder : folders) {
    int items = 0;
    for (const safety_case::SoftwareItem& item : safety_case.risk.items)
      for (const std::string& named : item.folders) items += covers(named, folder) ? 1 : 0;
    EXPECT_EQ(items, 1) << folder;
  }
  for (const safety_case::SoftwareItem& item : safety_case.risk.items)
    for (const std::string& named : item.folders) EXPECT_TRUE(fs::is_directory(kSource / named)) << named;
}

// Without epoch, revision of the distribution and its repackaging: "1:1.2.13.dfsg-1" is 1.2.13.
std::string makers_version(std::string version) {
  version = version.substr(version.find(':') + 1);  // npos + 1 is 0
  version = version.substr(0, version.rfind('-'));
  return std::regex_replace(version, std::regex(R"([+.](dfsg|ds)\d*$)"), "");
}

std::string installed_version(const Soup& soup) {
  if (soup.manager == "npm") {
    const nlohmann::json page = json_of(kSource / "robot/console/page/package.json");
    return page.at("dependencies").value(soup.package, "none");
  }
  return makers_version(shell("dpkg-query -W -f='${Version}' '" + soup.package + "' 2>/dev/null").text);
}

// The list names packages and versions of one system: on another one it would have to be written anew, with
// the anomalies known there.
bool is_system_of_list() {
  return file_content("/etc/os-release").find("VERSION_CODENAME=bookworm") != std::string::npos;
}

TEST(SoupList, HasTheVersionsThatAreInstalled) {
  if (!is_system_of_list()) GTEST_SKIP() << "software.toml lists the packages of Debian 12";
  ASSERT_EQ(shell("dpkg-query --version >/dev/null 2>&1").code, 0)
      << "dpkg-query says which versions these are";
  const SafetyCase safety_case = shipped_case();
  for (const Soup& soup : safety_case.risk.soup)
    EXPECT_EQ(installed_version(soup), soup.version)
        << soup.package << ": read its known anomalies again, then correct safety/case/software.toml";
}

TEST(SoupList, NamesEveryLibraryThatTheProgramLoadsAndEveryPackageOfThePage) {
  if (!is_system_of_list()) GTEST_SKIP() << "software.toml lists the libraries of Debian 12";
  const SafetyCase safety_case = shipped_case();
  const auto listed = [&](const std::string& library) {
    for (const Soup& soup : safety_case.risk.soup)
      for (const std::string& name : soup.libraries)
        if (library.starts_with(name)) return true;
    return false;
  };
  const std::string header = shell("objdump -p '" + program() + "'").text;
  const std::regex needed(R"(NEEDED\s+(\S+))");
  int libraries = 0;
  for (std::sregex_iterator match(header.begin(), header.end(), needed), end; match != end;
       ++match, ++libraries)
    EXPECT_TRUE(listed((*match)[1])) << (*match)[1] << " is in no entry of software.toml";
  EXPECT_GT(libraries, 10) << header;
  const auto page = json_of(kSource / "robot/console/page/package.json");
  for (const auto& [package, version] : page.at("dependencies").items()) {
    const auto& soups = safety_case.risk.soup;
    EXPECT_TRUE(std::any_of(soups.begin(), soups.end(), [&](const Soup& s) { return s.package == package; }))
        << package;
  }
}

// In a build tree where only the program was built, as `./dev run` leaves it.
TEST(SafetyCaseCommand, SaysInOneLineThatNothingIsBuiltAndLeavesNothing) {
  const ScratchFolder folder;
  fs::copy_file(program(), folder / "biopsy");
  folder.write("source_folder.txt", kSource.string() + "\n");
  const std::string out = (folder / "case").string();
  const Outcome outcome =
      shell("'" + (folder / "biopsy").string() + "' safety-case --quick --out " + out + " 2>&1");
  EXPECT_EQ(outcome.code, 2) << outcome.text;
  EXPECT_TRUE(std::regex_search(outcome.text, std::regex(R"(\d+ of \d+ programs of evidence are not built)")))
      << outcome.text;
  EXPECT_NE(outcome.text.find("./dev safety-case --quick"), std::string::npos) << outcome.text;
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace biopsy::cli_tests
