// biopsy effects: the library of effects, for people, programs and docs/reference/effects.md.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "robot/cli/commands.hpp"
#include "robot/common/config_error.hpp"
#include "sim/plant/effect_labels.hpp"
#include "sim/plant/plant_model.hpp"

namespace biopsy::robot {
namespace {

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

// Letters to insert, drop or change to make one word of the other (Levenshtein 1966).
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, diagonal + 1, changed});
    }
  }
  return row.back();
}

bool is_close(std::string_view typed, std::string_view name) {
  return (typed.size() >= 3 && name.find(typed) != std::string_view::npos) ||
         distance(typed, name) <= std::max<std::size_t>(2, name.size() / 4);
}

[[noreturn]] void refuse(const std::string& typed, const std::vector<EffectCard>& cards) {
  std::string close;
  for (const EffectCard& card : cards)
    if (is_close(typed, card.info.name))
      close += fmt::format("{}{}", close.empty() ? "" : ", ", card.info.name);
  throw ConfigError(fmt::format("no effect is called `{}`", typed), "biopsy effects",
                    close.empty() ? "`biopsy effects` lists all names"
                                  : fmt::format("close: {}; `biopsy effects` lists all names", close));
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

void print_list(const std::vector<EffectCard>& cards) {
  for (const EffectCard& card : cards)
    fmt::print("{:<22} {:<11} {}\n", card.info.name, card.attaches, card.info.sentence);
  fmt::print("\n{} effects; more on one: biopsy effects {}\n", cards.size(), cards.front().info.name);
}

void print_one(const EffectCard& card) {
  fmt::print("{}\n{}\n\n", card.info.name, card.info.sentence);
  fmt::print("attaches    {}\nequation    {}\nexperiment  {}\nsource      {}\n\n", card.attaches,
             card.info.equation, card.info.experiment, card.info.source);
  fmt::print("{:<26} {:>16} {:>9}  {:<10} {}\n", "parameter", "range", "typical", "role", "meaning");
  for (const ParameterCard& p : card.parameters)
    fmt::print("{:<26} {:>16} {:>9}  {:<10} {}\n", p.name, fmt::format("{} to {}", p.low, p.high), p.typical,
               p.role, p.meaning);
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

}  // namespace

int effects(const EffectsOptions& options) {
  const std::vector<EffectCard> cards = chosen(options.name);
  if (options.markdown) {
    fmt::print("{}", page_of(cards));
  } else if (options.json) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const EffectCard& card : cards) all.push_back(json_of(card));
    fmt::print("{}\n", (options.name.empty() ? all : all.front()).dump(2));
  } else if (options.name.empty()) {
    print_list(cards);
  } else {
    print_one(cards.front());
  }
  return 0;
}

}  // namespace biopsy::robot
