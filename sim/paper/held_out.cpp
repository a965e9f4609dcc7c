#include "sim/paper/held_out.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "robot/common/files/file.hpp"
#include "robot/common/files/toml_reader.hpp"
#include "robot/common/sha256.hpp"
#include "robot/common/text/encoding.hpp"

namespace biopsy::sim::paper {
namespace {

constexpr double kMost = 1e12;  // of a row, and of a count
constexpr std::uint32_t kMostRows = 100'000;

// In TOML's basic strings only these two need an escape here: names of rows have no control characters.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

std::string digest(const std::filesystem::path& file) {
  return hex(sha256(read_file(file)));
}

template <class Found>
void for_each_pair(Reproduction& reproduction, const std::vector<HeldOutRow>& rows, Found&& found) {
  for (PaperFigure& figure : reproduction.figures)
    for (PaperRow& row : figure.rows) {
      const auto same = std::find_if(rows.begin(), rows.end(), [&](const HeldOutRow& other) {
        return other.figure == row.figure && other.quantity == row.quantity;
      });
      if (same != rows.end()) found(row, *same);
    }
}

}  // namespace

ModelDigests digests_of(const std::filesystem::path& stage, const std::filesystem::path& paper) {
  return {digest(stage), digest(paper)};
}

std::string held_out_toml(const HeldOut& held_out) {
  std::string text = fmt::format(
      "# Each figure of the paper by a calibration on all other figures: what the model predicts instead of "
      "what\n"
      "# it was fitted to. Written by `biopsy calibrate --leave-one-out`; it stands beside the model of "
      "these digests.\n"
      "command = {}\nstage_sha256 = \"{}\"\npaper_sha256 = \"{}\"\nunknowns = {}\nnumbers = {}\nstatements = "
      "{}\n",
      quoted(held_out.command), held_out.model.stage, held_out.model.paper, held_out.unknowns,
      held_out.numbers, held_out.statements);
  for (const HeldOutRow& row : held_out.rows) {
    text += fmt::format("\n[[row]]\nfigure = {}\nquantity = {}\nok = {}\n", quoted(row.figure),
                        quoted(row.quantity), row.ok);
    if (std::isfinite(row.ours)) text += fmt::format("ours = {:.6g}\n", row.ours);
  }
  return text;
}

HeldOut read_held_out(const std::filesystem::path& file) {
  return read_toml(file, [](TomlTable& root) {
    HeldOut out;
    out.command = root.text("command");
    out.model = {root.text("stage_sha256"), root.text("paper_sha256")};
    out.unknowns = root.whole_number("unknowns", kMostRows);
    out.numbers = root.whole_number("numbers", kMostRows);
    out.statements = root.whole_number("statements", kMostRows);
    for (TomlTable& table : root.tables("row"))
      out.rows.push_back(
          {table.text("figure"), table.text("quantity"),
           table.has("ours") ? table.number("ours", -kMost, kMost) : std::numeric_limits<double>::quiet_NaN(),
           table.flag("ok")});
    return out;
  });
}

void add_held_out(Reproduction& reproduction, const HeldOut& held_out) {
  reproduction.fitted = FittedTo{held_out.unknowns, held_out.numbers, held_out.statements, held_out.command};
  for_each_pair(reproduction, held_out.rows, [](PaperRow& row, const HeldOutRow& held) {
    row.held_out = HeldOutValue{held.ours, held.ok};
  });
}

void add_leakage_model(Reproduction& reproduction, const Reproduction& leakage_model) {
  std::vector<HeldOutRow> rows;
  for (const PaperFigure& figure : leakage_model.figures)
    for (const PaperRow& row : figure.rows)
      if (row.kind != RowKind::Shown) rows.push_back({row.figure, row.quantity, row.ours, row.ok});
  for_each_pair(reproduction, rows,
                [](PaperRow& row, const HeldOutRow& other) { row.leakage_ok = other.ok; });
}

}  // namespace biopsy::sim::paper
