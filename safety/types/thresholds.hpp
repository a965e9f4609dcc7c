// Thresholds of the detectors, each with its reason. Constants of the build; the limits of the robot itself
// are in safety/types/limits.hpp. Times are debounced in ticks of 1 ms.
#pragma once

#include <cstdint>

namespace biopsy::safety {

// Clocks and messages
// Safety concept: dt > 5 ms is a jump (and so is dt <= 0).
inline constexpr std::int64_t kClockStepMax_us = 5'000;
// A sound step and what the ticks before it left over.
inline constexpr std::int32_t kElapsedMax_ms = 6;
inline constexpr std::int32_t kStale_ticks = 3;  // safety concept: sensor stale > 3 ms; the same for requests
inline constexpr std::int64_t kInterlock_us = 20'000;  // safety concept: HV off 20 ms after either side stops
// Wrong +2, right -1, above 2 trips.
inline constexpr std::int32_t kScoreWrong = 2, kScoreTrip = 2, kScoreMax = 4;
inline constexpr std::uint32_t kAnswerWindow = 5;  // permits: as long as one lives (5 ms)
// The third missed period within 100 ms: a miss adds 100, a tick takes 1.
inline constexpr std::int32_t kMiss = 100, kMissTrip = 200, kMissMax = 400;
// A step of the stage's clock of this length has left a period out: its next tick comes a quarter of a period
// later at the soonest. The longest single stall: see kStale_ticks.
inline constexpr std::int64_t kStageLate_us = 1'750;
inline constexpr std::int32_t kEStopDisagree_ticks = 20;  // safety concept: two contacts of one button
// Contacts bounce for a few ms: closed is what was closed for 20 ms, open is what is open once.
inline constexpr std::int32_t kContact_ticks = 20;
inline constexpr std::int64_t kPanelRead_us =
    20'000;  // as late as the interlock's timers, which cannot read it
// The interlock's 20 ms, two periods of its own and a permit's life on the bus.
inline constexpr std::int32_t kRelay_ticks = 30;
// A day's work: what failed since the last press is found before the next day's first patient.
inline constexpr std::int64_t kPanelTest_us = 24LL * 3'600 * 1'000'000;
// Nobody turns a key for so long without voltage: it is stuck, and the panel has to be tested anew.
inline constexpr std::int64_t kKeyStuck_us = 10'000'000;
inline constexpr std::int32_t kLogBacklog_ms = 1'000;     // safety concept
inline constexpr std::int32_t kPatientMotion_um = 2'000;  // safety concept
// Longer than the jump of a puncture, and ten times the reaction to anything quick.
inline constexpr std::int32_t kSuspect_ticks = 100;
inline constexpr std::int32_t kWrongModel_ticks = 1'100;  // held a second and still unlike the plan

// Faults that come and go (accumulated() in safety/monitors/debounce.hpp): a loose contact, a sparking joint.
// Found where they show in more than a third of the samples; single spikes are forgotten two ticks later.
inline constexpr std::int32_t kComes_goes = 2;

// Voltage
inline constexpr std::int32_t kOverVoltage_ticks = 2;       // one sample may be a spike of the converter
inline constexpr std::int32_t kDisagree_ticks = 3;          // safety concept: > 3 % for 3 ms
inline constexpr std::int32_t kDisagree_percent = 3;        // monitor noise is 0.2 %
inline constexpr std::int32_t kDisagreeFloor_mV = 100'000;  // 1 % of the amplifier's 10 kV: its offset error
inline constexpr std::int32_t kDisobey_ticks = 3;           // two ticks of transport are allowed
// Three ticks of a C1 ramp from 8 kV (32 V each), doubled
inline constexpr std::int32_t kDisobey_mV = 200'000;
inline constexpr std::int32_t kZero_ticks = 3;        // measured zero must last
inline constexpr std::int32_t kResidual_ticks = 200;  // safety concept: > 100 V 200 ms after off
// Arc. i = C1 d(u_i - u_o)/dt. Leakage makes u_o follow u_i with 0 <= K <= 1, so that the mean current of a
// tick is at most C1 |dV| / T: 2 nF over 1 ms is 2 nA for each mV of commanded change, whatever K (a flip of
// 16 kV: 32 mA). The decay of u_o between samples adds C1 |u_o| / tau <= 2 nF 8 kV / 6.9 s = 2.3 uA, inside
// the margin. A step may show in the tick it was put out or, with lag of amplifier and monitor, in the next
// two: the largest of three counts.
inline constexpr std::int64_t kCapacitive_nA_per_mV = 2;
// 2.5 % of the amplifier's 40 mA; an arc draws several mA
inline constexpr std::int64_t kArcMargin_nA = 1'000'000;
inline constexpr std::int32_t kArc_ticks = 2;  // safety concept: 2 samples

// Square wave: 2 Hz, amplitude from 1 kV up (below, a change of sign cannot be told from amplitude control)
inline constexpr std::int32_t kWaveMin_mV = 1'000'000;
inline constexpr std::int32_t kHalfPeriod_ticks = 250;  // paper: 2 Hz; the only one with a patient
// A plan for the bench may declare another one. Fastest: 10 Hz, the paper's highest. Slowest: 0.2 Hz; a stuck
// polarity is then seen after 15 s, little more than the 10 s of one polarity that every hold may last.
inline constexpr std::int32_t kBenchHalfPeriodMin_ticks = 50, kBenchHalfPeriodMax_ticks = 2'500;
inline constexpr std::int64_t kTwoPeriods_half_periods = 4, kOffOneIn = 5;  // safety concept: 20 %
inline constexpr std::int64_t kForget_ticks = 2'048;                        // four periods at 2 Hz, no less
// Evaluated once half of that was seen; a sound wave then has < 25 % (half a half-period), a stuck one 100 %.
inline constexpr std::int64_t kForgetPerSeen = 2;

// The films pull less on the way up than on the way down: a locked needle is lifted past the drive that held
// it, by twice the voltage that their adhesion takes (0.3 kV and two of its deviations), and a margin.
inline constexpr std::int32_t kPastLocked_mV = 1'200'000;

// Runaway. The pull of the pouches goes with V^2; friction may hold the needle against it and then let go. So
// the pull leads its own mean over the last 128 ms by 1.2 kV^2 at most: 1.1 kV from rest, 0.23 kV at 2.5 kV.
// Requested by healthy procedures: median 0.8, 90th percentile 1.1 kV^2; the rest are briefly limited.
inline constexpr std::int64_t kPull_ticks = 128, kPullLead_V2 = 1'200'000;

// Depth
inline constexpr std::int32_t kDepth_ticks = 2;              // one sample may be a spike of the laser
inline constexpr std::int64_t kReaction_us = 5'000;          // T in d + v T: a permit's life
inline constexpr std::int64_t kDecel_um_per_s2 = 5'000'000;  // a: half of gravity, which withdraws the needle
inline constexpr std::int32_t kFastDrop_um_per_s = 50'000;   // safety concept; planned motion is < 20 mm/s
// Advance within 10 ms: motion at 20 mm/s makes 0.2 mm and a planned puncture another 0.3-0.5 mm; the margin
// is 1 mm.
inline constexpr std::int32_t kPopThrough_um = 800;
inline constexpr std::int32_t kDropout_ticks = 3;  // as for a stale sensor
inline constexpr std::int32_t kDropoutTrip = kComes_goes * kDropout_ticks;
inline constexpr std::int32_t kFrozen_ticks = 20;  // safety concept; noise of 10 um changes the code every ms
inline constexpr std::int32_t kFrozenMove_mV = 200'000;  // "while V moves": twice what counts as zero
// Work without motion: |V|^2 beyond what made the deepest depth that was seen. Whatever is shown instead of
// the needle (still with noise, a loop of old samples, another surface), the loop answers it with pull.
// Second line behind the two lasers, for what both of them show: of 600 rehearsals on stages of the posterior
// 24 kV^2 stop none, 16 one, 10 thirty-seven; on the nominal stage 24 kV^2 are 3.6 mm of needle, 16 kV^2 2.9
// mm.
inline constexpr std::int32_t kAdvanced_um =
    100;  // five deviations of the mean of eight, with 50 um of noise
inline constexpr std::int64_t kIdlePull_V2 = 24'000'000;
inline constexpr std::int32_t kIdle_ticks = 20;
// Up to the first motion: a multiple of the pull that the plausible band says could lift at all. Its upper
// edge has friction and hysteresis for it, a stage on the way up both against it.
inline constexpr std::int32_t kLifted_um = 1'000;
inline constexpr std::int64_t kLiftPulls = 3;
// The two lasers: 0.3 mm is four deviations of the difference of two with 50 um of noise each, and 20 mm/s
// make 0.1 mm of 5 ms between them; in 10 ms a needle at 20 mm/s passes 0.2 mm more.
inline constexpr std::int32_t kDiffer_um = 300, kDiffer_ticks = 10;
// A laser that shows the needle and another surface by turns: more than every fifth sample apart is found, so
// what the loop is shown is off in the mean by less than a fifth of that distance.
inline constexpr std::int32_t kDifferWeight = 4, kDifferTrip = kDifferWeight * kDiffer_ticks;
inline constexpr std::int32_t kImplausible_um = 1'000;  // safety concept: residual > 1 mm ...
inline constexpr std::int32_t kImplausible_ticks = 50;  // ... for 50 ms
// Back without a drive lowered by 200 V in half a second: the charge that leaks between two changes of
// polarity makes 0.35 mm in the softest of 1200 healthy procedures. Slower than a fall, which is named first.
inline constexpr std::int32_t kLowered_mV = 200'000, kSunk_um = 600, kSunk_ticks = 20;
// Films creep: of a stage drawn from the calibration the needle sank by 0.65 mm in the three seconds after
// the drive had come down by 2.7 kV. What a walking zero can do meanwhile is bounded by the drive, which ends
// this where it rises by kLowered_mV.
inline constexpr std::int32_t kCreeping_ticks = 4'000;
// Let go by the brake, a needle falls to where the films, which came from a smaller pull than before the
// scan, carry it: by 0.6 mm and within 100 ms in healthy procedures. Half a period, in which a zero that
// walks by 1 mm/s is off by 0.25 mm; one that jumps then is found by the second laser.
inline constexpr std::int32_t kSettling_ticks = 250;
// Of the mean of eight readings: two and a half of its deviations with 27 um of noise, so that a needle seen
// within kStill_um less this is within kStill_um. Longer than the noise is correlated.
inline constexpr std::int32_t kStillNoise_um = 25, kSlip_ticks = 20;
inline constexpr std::int32_t kNotBack_ticks = 500;  // safety concept: > 1 mm 500 ms after 0 V

// Supervisor
inline constexpr std::int32_t kBootMax_ms = 10'000;  // a self-test that has not passed by then has failed
// A console that fell silent must not move the needle by more than 2 mm (20 mm/s); a release stops it at
// once.
inline constexpr std::int32_t kHeldTimeout_ms = 100;
inline constexpr std::int32_t kRamp_ms = 250;  // envelope at 0 with 50 ms left to see V = 0 before 300 ms

}  // namespace biopsy::safety
