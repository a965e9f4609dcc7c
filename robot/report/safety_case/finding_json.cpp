#include "robot/report/safety_case/finding_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "robot/common/config_error.hpp"

namespace biopsy::safety_case {
namespace {

using nlohmann::json;

[[noreturn]] void refuse(const std::string& what, const std::string& name) {
  throw ConfigError(what, name, "let `biopsy safety-case` write it anew");
}

// Runs `read` on the parsed text; whatever is missing or of another type is said with the file's name.
template <class Read>
auto reading(const std::string& text, const std::string& name, Read read) {
  try {
    return read(json::parse(text));
  } catch (const json::exception& error) {
    refuse(fmt::format("is no evidence: {}", error.what()), name);
  }
}

std::string text_of(const json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return fmt::format("{:.4g}", value.get<double>());
  return value.dump();
}

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> out;
  for (std::size_t at = 0; at < list.size();) {
    const std::size_t end = std::min(list.find(',', at), list.size());
    out.push_back(list.substr(at, end - at));
    at = end + 1;
  }
  return out;
}

void read_figures(const json& figures, const std::string& name, Finding& finding) {
  for (const auto& [figure, value] : figures.items()) {
    const auto number = value.get<double>();
    if (!std::isfinite(number)) refuse(fmt::format("figure {} is not a number", figure), name);
    finding.figures[figure] = number;
  }
}

void read_tables(const json& tables, Finding& finding) {
  for (const auto& [table, rows] : tables.items())
    for (const json& row : rows) {
      Row out;
      for (const auto& [column, value] : row.items()) out[column] = text_of(value);
      finding.tables[table].push_back(out);
    }
}

// Numbers that tests record of themselves, such as a time measured: the largest counts.
void take_number(const std::string& key, const json& value, Finding& finding) {
  if (!value.is_string()) return;
  const auto text = value.get<std::string>();
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(number)) return;
  const auto [kept, is_new] = finding.figures.emplace(key, number);
  if (!is_new) kept->second = std::max(kept->second, number);
}

bool is_gtests_own(const std::string& key) {
  for (const char* own : {"name", "file", "line", "status", "result", "timestamp", "time", "classname",
                          "value_param", "type_param", "failures", "skipped", "verifies"})
    if (key == own) return true;
  return false;
}

TestResult test_of(const json& suite, const json& test, Finding& finding) {
  TestResult out;
  out.name = suite.at("name").get<std::string>() + "." + test.at("name").get<std::string>();
  const bool ran = test.at("status") == "RUN" && test.at("result") == "COMPLETED";
  out.passed = ran && !test.contains("failures");
  out.verifies = split(test.value("verifies", ""));
  for (const auto& [key, value] : test.items())
    if (!is_gtests_own(key)) take_number(key, value, finding);
  return out;
}

json to_json(const std::vector<TestResult>& tests) {
  json out = json::array();
  for (const TestResult& test : tests)
    out.push_back({{"name", test.name}, {"passed", test.passed}, {"verifies", test.verifies}});
  return out;
}

}  // namespace

void read_proof(const std::string& text, const std::string& name, Finding& finding) {
  reading(text, name, [&](const json& root) {
    finding.passed = root.at("passed").get<bool>();
    read_figures(root.at("figures"), name, finding);
    if (root.contains("tables")) read_tables(root.at("tables"), finding);
  });
}

void read_tests(const std::string& text, const std::string& name, Finding& finding) {
  reading(text, name, [&](const json& root) {
    for (const json& suite : root.at("testsuites"))
      for (const json& test : suite.at("testsuite")) finding.tests.push_back(test_of(suite, test, finding));
  });
  const auto failed = std::count_if(finding.tests.begin(), finding.tests.end(),
                                    [](const TestResult& test) { return !test.passed; });
  finding.figures["tests"] = static_cast<double>(finding.tests.size());
  finding.figures["failed"] = static_cast<double>(failed);
  finding.passed = failed == 0 && !finding.tests.empty();
}

std::string to_json(const Finding& finding) {
  json out{{"source", finding.source},       {"date", finding.date},       {"commit", finding.commit},
           {"code", finding.code},           {"seconds", finding.seconds}, {"quick", finding.quick},
           {"passed", finding.passed},       {"figures", finding.figures}, {"tables", finding.tables},
           {"tests", to_json(finding.tests)}};
  return out.dump(1) + "\n";
}

Finding finding_from_json(const std::string& text, const std::string& name) {
  Finding finding;
  read_proof(text, name, finding);
  reading(text, name, [&](const json& root) {
    finding.source = root.at("source").get<std::string>();
    finding.date = root.at("date").get<std::string>();
    finding.commit = root.at("commit").get<std::string>();
    finding.code = root.at("code").get<std::string>();
    finding.seconds = root.at("seconds").get<double>();
    finding.quick = root.at("quick").get<bool>();
    for (const json& test : root.at("tests"))
      finding.tests.push_back({test.at("name").get<std::string>(), test.at("passed").get<bool>(),
                               test.at("verifies").get<std::vector<std::string>>()});
  });
  return finding;
}

}  // namespace biopsy::safety_case
