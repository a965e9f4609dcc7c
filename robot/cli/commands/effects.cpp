// biopsy effects: the library of effects, for people, programs and docs/reference/effects.md.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "robot/cli/command.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/text/closest_names.hpp"
#include "sim/effects/effect_labels.hpp"
#include "sim/plant/plant_model.hpp"

namespace biopsy::robot {
namespace effects_cli {

struct ParameterCard {
  std::string name, unit;  // name with its unit, as in files; unit as people write it
  double low, high, typical;
  std::string role, meaning;
  bool optional;  // may be left out of a file
};

struct EffectCard {
  sim::EffectInfo info;
  std::string attaches;
  std::vector<ParameterCard> parameters;
};

std::vector<EffectCard> library() {
  std::vector<EffectCard> cards;
  const sim::Effects none;
  sim::for_each_effect(none, [&](const auto& slot) {
    using Effect = typename std::decay_t<decltype(slot)>::value_type;
    EffectCard card{Effect::info, std::string(name_of(Effect::info.attaches)), {}};
    for (const auto& p : Effect::parameters())
      card.parameters.push_back({std::string(p.name), sim::unit_of(p.name), p.low, p.high, p.typical,
                                 std::string(name_of(p.role)), std::string(p.meaning), p.optional});
    cards.push_back(std::move(card));
  });
  return cards;
}

[[noreturn]] void refuse(const std::string& typed, const std::vector<EffectCard>& cards) {
  std::vector<std::string> names;
  for (const EffectCard& card : cards) names.emplace_back(card.info.name);
  const std::vector<std::string> close = closest_names(typed, names);
  throw ConfigError(fmt::format("no effect is called `{}`", typed), "biopsy effects",
                    close.empty()
                        ? "`biopsy effects` lists all names"
                        : fmt::format("close: {}; `biopsy effects` lists all names", fmt::join(close, ", ")));
}

std::vector<EffectCard> chosen(const std::string& name) {
  std::vector<EffectCard> cards = library();
  if (name.empty()) return cards;
  for (const EffectCard& card : cards)
    if (card.info.name == name) return {card};
  refuse(name, cards);
}

nlohmann::ordered_json json_of(const EffectCard& card) {
  nlohmann::ordered_json parameters = nlohmann::ordered_json::array();
  for (const ParameterCard& p : card.parameters)
    parameters.push_back({{"name", p.name},
                          {"unit", p.unit},
                          {"low", p.low},
                          {"high", p.high},
                          {"typical", p.typical},
                          {"role", p.role},
                          {"meaning", p.meaning},
                          {"optional", p.optional}});
  return {{"name", card.info.name},         {"attaches", card.attaches}, {"sentence", card.info.sentence},
          {"equation", card.info.equation}, {"parameters", parameters},  {"experiment", card.info.experiment},
          {"source", card.info.source}};
}

std::string list_text(const std::vector<EffectCard>& cards) {
  std::string text;
  for (const EffectCard& card : cards)
    text += fmt::format("{:<22} {:<11} {}\n", card.info.name, card.attaches, card.info.sentence);
  return text +
         fmt::format("\n{} effects; more on one: biopsy effects {}\n", cards.size(), cards.front().info.name);
}

std::string one_text(const EffectCard& card) {
  std::string text = fmt::format("{}\n{}\n\n", card.info.name, card.info.sentence);
  text += fmt::format("attaches    {}\nequation    {}\nexperiment  {}\nsource      {}\n\n", card.attaches,
                      card.info.equation, card.info.experiment, card.info.source);
  text += fmt::format("{:<26} {:>16} {:>9}  {:<10} {}\n", "parameter", "range", "typical", "role", "meaning");
  for (const ParameterCard& p : card.parameters)
    text += fmt::format("{:<26} {:>16} {:>9}  {:<10} {}\n", p.name, fmt::format("{} to {}", p.low, p.high),
                        p.typical, p.role, p.meaning);
  return text;
}

// Text inside a cell of a table.
std::string cell(std::string_view text) {
  std::string out;
  for (const char letter : text) {
    if (letter == '|') out += '\\';
    out += letter;
  }
  return out;
}

constexpr const char* kPageHead = R"(# Effects

The library of physical terms that a model of the needle stage may contain, or lack. An effect that is absent is exactly
the [baseline](../explanation/model.md#1-baseline-the-papers-equations-nothing-else). In a [model file](model-files.md#model) each one that is
present has a table `[effect.NAME]` with all its parameters. The experiment is the one that shows the effect most clearly.

This page is generated; a test compares it with the program. Renew it, do not edit it:

```sh
biopsy effects --markdown > docs/reference/effects.md
```

What a parameter does in its effect: a *strength* of 0 makes the effect vanish (all strengths, where there are several); a
*shape* says how it acts; a *place* where along the displacement; a *level* above which voltage; a *frequency* and a
*phase* belong to something periodic.

| effect | attaches | what it does |
|---|---|---|
)";

// As code, whether or not it holds backticks itself.
std::string code(std::string_view text) {
  return text.find('`') == std::string_view::npos ? fmt::format("`{}`", text) : fmt::format("`` {} ``", text);
}

std::string markdown_of(const EffectCard& card) {
  std::string out = fmt::format(
      "\n## {}\n\n{}\n\n- attaches: {}\n- equation: {}\n- experiment: `{}`\n- source: {}\n\n", card.info.name,
      card.info.sentence, card.attaches, code(card.info.equation), card.info.experiment, card.info.source);
  out += "| parameter | unit | range | typical | role | meaning |\n|---|---|---|---|---|---|\n";
  for (const ParameterCard& p : card.parameters)
    out += fmt::format("| `{}` | {} | {} to {} | {} | {} | {} |\n", p.name, p.unit, p.low, p.high, p.typical,
                       p.role, cell(p.meaning));
  return out;
}

std::string page_of(const std::vector<EffectCard>& cards) {
  std::string page = kPageHead;
  for (const EffectCard& card : cards)
    page += fmt::format("| [`{0}`](#{0}) | {1} | {2} |\n", card.info.name, card.attaches,
                        cell(card.info.sentence));
  for (const EffectCard& card : cards) page += markdown_of(card);
  return page;
}

struct Options {
  std::string name;       // empty: all
  bool markdown = false;  // docs/reference/effects.md
};

void declare(CLI::App& app, Options& options) {
  CLI::Option* name =
      add(app, "NAME", options.name, "one effect; of an unknown name the close ones are named", "all");
  app.add_flag("--markdown", options.markdown, "print the page [effects](effects.md)")->excludes(name);
}

Result run(const Options& options, const Context& context) {
  if (options.markdown && context.json)
    throw ConfigError("both --json and --markdown", "biopsy effects", "give one of them");
  const std::vector<EffectCard> cards = chosen(options.name);
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const EffectCard& card : cards) all.push_back(json_of(card));
  return {.text = options.markdown       ? page_of(cards)
                  : options.name.empty() ? list_text(cards)
                                         : one_text(cards.front()),
          .json = (options.name.empty() ? all : all.front()).dump(2) + "\n"};
}

}  // namespace effects_cli

Command effects_command() {
  using namespace effects_cli;
  return {.name = "effects",
          .summary = "what a model may contain besides its baseline",
          .description =
              "Lists the [library of effects](effects.md); with a name the equation, parameters, "
              "source and best experiment of one.",
          .examples = {"biopsy effects", "biopsy effects coulomb_friction --json"},
          .exit_codes = "0, or 2 for a name that is not in the library",
          .json =
              "the effect, or a list of all: `name`, `attaches`, `sentence`, `equation`, `parameters` (list "
              "of `name`, `unit`, `low`, `high`, `typical`, `role`, `meaning`, `optional`), `experiment`, "
              "`source`",
          .declare = with_options(declare, run)};
}

}  // namespace biopsy::robot
