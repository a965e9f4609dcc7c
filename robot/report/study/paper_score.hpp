// How much of the paper is reached, and the words for one row of it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/paper/paper_figure.hpp"

namespace biopsy::report {

// Of the rows that were compared with something: how many, and how many of them were met.
struct Share {
  std::size_t of = 0, ok = 0;

  void add(bool met) {
    ++of;
    if (met) ++ok;
  }
};

// Rows that are only shown count nowhere.
struct PaperScore {
  std::size_t numbers = 0, numbers_ok = 0;  // bounds included
  std::size_t trends = 0, trends_ok = 0;
  std::size_t theory = 0, theory_ok = 0;      // closed forms against the simulation: no numbers of the paper
  std::size_t bounds = 0, bounds_ok = 0;      // of the numbers those that the paper gives as "less than"
  Share leakage_numbers{}, leakage_trends{};  // what the leakage model without effects meets
  Share beyond_leakage{};  // what this model meets of the rows that the leakage model misses
  Share held_out_numbers{}, held_out_trends{};  // each figure by a calibration on the others

  void add(const PaperRow& row);
  // The bar has two parts: nine numbers of ten within their band, and every trend as stated.
  bool enough_numbers() const { return 10 * numbers_ok >= 9 * numbers; }
  bool every_trend() const { return trends_ok == trends; }
};

PaperScore score_of(const PaperFigure& figure);
PaperScore score_of(const Reproduction& reproduction);

// "36 of 40 of the paper's numbers within their band (30 of 34 to be met, 6 of 6 bounds), trends 18 of 18,
// closed forms 5 of 5"
std::string score_sentence(const PaperScore& score);

// What the score rests on, a sentence each: fitted to what, held out, and what the leakage model meets
// anyway.
std::vector<std::string> score_remarks(const Reproduction& reproduction);

std::string leakage_text(const PaperRow& row);   // "met too", "missed", an en dash where it was not compared
std::string held_out_text(const PaperRow& row);  // "✓ 0.0843 mm", "■ does not hold", an en dash

// A row that was counted and is not reached.
bool is_missed(const PaperRow& row);
std::vector<const PaperRow*> missed_rows(const Reproduction& reproduction);

std::string paper_text(const PaperRow& row);    // "0.077 mm", "at most 10 %", "as stated"
std::string ours_text(const PaperRow& row);     // "0.0801 mm", "holds"
std::string band_text(const PaperRow& row);     // "± 20 %", an en dash where there is none
std::string verdict_text(const PaperRow& row);  // "✓ within", "■ missed", "· shown"
std::string kind_name(RowKind kind);            // as in reproduce.json

// Three digits that count, in the fewest letters people read: "0.0801", "48.1", "5230".
std::string three_digits(double value);

}  // namespace biopsy::report
