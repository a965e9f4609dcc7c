/* The compiled supervisor as Spin's model calls it. All of its state that Spin stores and compares. */
#ifndef BIOPSY_SPIN_ENTRY_H
#define BIOPSY_SPIN_ENTRY_H

#ifdef __cplusplus
extern "C" {
#endif

typedef struct SpinState {
  unsigned short ticks; /* time in the mode; in Active: silence */
  unsigned char mode, step, step_done, arm_was_down, reset_was_down, any_token;
} SpinState;

/* One tick's inputs, small numbers. hazard: 0 none, 1 C2, 2 C1, 3 C0, 4 locking. motion: 2 x {nothing, old,
   present, new} + held. depth: 0 refused, 1 accepted, 2 accepted for another step. */
typedef struct SpinInput {
  unsigned char hazard, stop, zero, arm, reset, remote, motion, self_test, home, reached, finished, depth;
  unsigned char jump; /* first let time pass until a tick before the last of this mode */
} SpinInput;

/* What the permit of this tick says, and what was true of the tick before. */
typedef struct SpinOutput {
  unsigned char before, event, enabled, may_rise, stop, epoch_raised, seq_raised, spent, done_before,
      confirms, step_before;
  int v_max_mV, envelope_before_mV;
} SpinOutput;

extern SpinState spin_state;
extern SpinOutput spin_output;

void spin_start(void);
/* exact: count every tick; else ticks between the first and the last but one are one. */
void spin_step(const SpinInput* input, int exact);

#ifdef __cplusplus
}
#endif
#endif
