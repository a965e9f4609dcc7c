// The result of `biopsy tune`: as a sentence, a page and JSON.
#pragma once

#include <string>

#include "robot/report/study/study_html.hpp"
#include "sim/paper/tuning/tune.hpp"

namespace biopsy::robot {

std::string tuning_sentence(const sim::tuning::Tuning& tuning);

report::StudyPage tuning_page(const sim::tuning::Tuning& tuning, const std::string& model);

std::string tuning_json(const sim::tuning::Tuning& tuning, const std::string& model, double seconds);

}  // namespace biopsy::robot
