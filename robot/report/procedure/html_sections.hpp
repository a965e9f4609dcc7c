// The sections of report.html, each a finished piece of HTML; empty where the record has nothing for it.
#pragma once

#include <string>

#include "robot/report/procedure/run_record.hpp"

namespace biopsy::report {

// html_tables.cpp
std::string patient_section(const RunRecord& record);
std::string steps_section(const RunRecord& record);
std::string checks_section(const RunRecord& record);
std::string limits_section(const RunRecord& record);
std::string trips_section(const RunRecord& record);
std::string faults_section(const RunRecord& record);
std::string provenance_section(const RunRecord& record);

// run_figure.cpp: depth against plan, drive voltage with its envelope and the supervisor's states on one time
// axis, with the steps shaded and images and trips marked.
std::string run_figure(const RunRecord& record);

// html_pictures.cpp
std::string plan_section(const RunRecord& record);
std::string figure_section(const RunRecord& record);
std::string images_section(const RunRecord& record);

}  // namespace biopsy::report
