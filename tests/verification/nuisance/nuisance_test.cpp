// The quick subset of the nuisance run, and that it can complain.
#include <gtest/gtest.h>

#include <iostream>

#include "tests/safety/verifies.hpp"
#include "tests/source_dir.hpp"
#include "tests/verification/nuisance/shift.hpp"

namespace biopsy::proof {
namespace {

Workshop workshop() {
  return open_workshop(source_dir() / "sim/models");
}

TEST(Nuisance, AnHourOfHealthyProceduresHasNoTrip) {
  const Shift day = work(workshop(), 1.0, 11, {}, [](double) {});
  EXPECT_EQ(day.trips, 0);
  EXPECT_LE(day.unexpected_stops,
            1);  // one is known: a stage that a puncture overshot, docs/explanation/verification.md
  for (const Alarm& alarm : day.alarms)
    std::cout << "procedure " << alarm.procedure << " at " << alarm.at_s << " s: " << alarm.what << '\n';
  EXPECT_GT(day.releases, 20);
  EXPECT_GT(day.given_up, 5);
}

TEST(Nuisance, ComplainsAboutASupervisorThatSeesWhatIsNotThere) {
  const auto nervous = [](safety::SupervisorInputs& seen) {
    if (seen.measurement.seq % 5'000 == 0) seen.patient_motion_um = 2'001;
  };
  const Shift day = work(workshop(), 0.01, 1, nervous, [](double) {});
  EXPECT_GT(day.unexpected_stops, 0);
  EXPECT_FALSE(day.alarms.empty());
}

TEST(Nuisance, CountsATripAsATrip) {
  const auto jumpy = [](safety::SupervisorInputs& seen) {
    if (seen.measurement.seq == 4'000) seen.writers = 2;
  };
  const Shift day = work(workshop(), 0.01, 1, jumpy, [](double) {});
  EXPECT_GT(day.trips + day.unexpected_stops, 0);
}

}  // namespace
}  // namespace biopsy::proof
