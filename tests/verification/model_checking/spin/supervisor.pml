/* The shipped supervisor under every input, as Spin sees it: the transition is a call of the compiled step, only
 * the world around it and the properties are written here.
 *
 * Run 1 (default): every input in every combination that can matter in a mode; time is either one tick or a jump
 *   to a tick before the last of the mode. Properties: assertions.
 * Run 2 (-DEXACT): every tick is counted, fewer inputs. Properties: LTL, liveness too.
 * Reduction: the rest of a tick is one atomic step; inputs that decide nothing in a mode are not varied there. */

#define BOOT 0
#define SAFE 1
#define READY 2
#define ARMED 3
#define ACTIVE 4
#define HOLD 5
#define RETRACT 6
#define TRIP 7
#define LOCK 8

c_decl {
\#include "entry.h"
}
c_track "&spin_state" "sizeof(SpinState)" "Matched"
c_track "&spin_output" "sizeof(SpinOutput)" "UnMatched"

byte mode = BOOT;
byte before = BOOT;
bool reset_turned = false;
bool arm_turned = false;
bool may_rise = false;
bool is_enabled = false;

hidden byte hazard; hidden byte stop; hidden byte motion; hidden byte depth_check; hidden byte self_test;
hidden byte step_before; hidden byte step;
hidden byte zero; hidden byte arm; hidden byte reset; hidden byte remote; hidden byte home; hidden byte step_reached;
hidden byte finished; hidden byte jump; hidden byte arm_was; hidden byte reset_was; hidden byte epoch_raised;
hidden byte seq_raised; hidden byte spent; hidden byte was_done; hidden byte confirms; hidden byte falls; hidden byte off;
hidden byte category; hidden byte new_token;

#define hot(m) (m == ARMED || m == ACTIVE || m == HOLD || m == RETRACT)
#define either(x) if :: x = 0 :: x = 1 fi

inline choose() {
#ifdef EXACT
  stop = 0; remote = 0; home = 1; self_test = 2; jump = 0; depth_check = 1; arm = 0; motion = 0;
  step_reached = 0; finished = 0;
  if :: hazard = 0 :: hazard = 2 :: hazard = 3 fi;
  either(zero);
  if
  :: mode == BOOT -> if :: self_test = 0 :: self_test = 1 :: self_test = 2 fi
  :: mode == READY || mode == TRIP -> either(arm)
  :: mode == ARMED || mode == HOLD -> if :: motion = 0 :: motion = 7 fi; either(finished)
  :: mode == ACTIVE -> if :: motion = 0 :: motion = 4 :: motion = 5 fi; either(step_reached)
  :: else
  fi;
  reset = arm
#else
  if :: hazard = 0 :: hazard = 1 :: hazard = 2 :: hazard = 3 :: hazard = 4 fi;
  either(zero);
  if :: stop = 0 :: stop = 1 :: stop = 2 :: stop = 3 fi;
  if :: motion = 0 :: motion = 1 :: motion = 2 :: motion = 3 :: motion = 4 :: motion = 5 :: motion = 6 :: motion = 7 fi;
  either(arm); either(reset); either(remote); either(jump);
  self_test = 2; home = 1; step_reached = 0; finished = 0; depth_check = 0;
  if :: mode == BOOT -> if :: self_test = 0 :: self_test = 1 :: self_test = 2 fi :: else fi;
  if :: mode == TRIP -> either(home) :: else fi;
  if :: mode == ACTIVE || mode == HOLD -> either(step_reached); either(finished) :: else fi;
  if :: mode == HOLD -> if :: depth_check = 0 :: depth_check = 1 :: depth_check = 2 fi :: else fi
#endif
}

/* One tick of the compiled supervisor; what came of it, where Promela can read it. */
inline tick() {
  c_code {
    SpinInput in = {hazard, stop, zero, arm, reset, remote, motion, self_test, home, step_reached, finished, depth_check, jump};
    arm_was = spin_state.arm_was_down;
    reset_was = spin_state.reset_was_down;
    new_token = motion == 7;
#ifdef EXACT
    spin_step(&in, 1);
#else
    spin_step(&in, 0);
#endif
    now.mode = spin_state.mode;
    now.before = spin_output.before;
    now.may_rise = spin_output.may_rise;
    now.is_enabled = spin_output.enabled;
    step = spin_state.step;
    step_before = spin_output.step_before;
    was_done = spin_output.done_before;
    confirms = spin_output.confirms;
    category = spin_output.stop;
    epoch_raised = spin_output.epoch_raised;
    seq_raised = spin_output.seq_raised;
    spent = spin_output.spent;
    off = !spin_output.enabled && spin_output.v_max_mV == 0 && !spin_output.may_rise;
    falls = spin_output.v_max_mV <= spin_output.envelope_before_mV;
  }
  arm_turned = arm && !arm_was;
  reset_turned = reset && !reset_was
}

#define implies(a, b) assert(!(a) || (b))
#define enters(m) (mode == m && before != m)
#define wanted_c0 (hazard >= 3 || stop == 3)

inline check() {
  implies(wanted_c0 && hot(before), mode == TRIP && off);
  implies(hazard >= 3, off);
  implies(may_rise, mode == ACTIVE);
  implies(mode == ACTIVE, hazard == 0 && stop == 0);
  implies(enters(ACTIVE), before == ARMED || before == HOLD);
  implies(enters(ACTIVE), new_token);
  implies(enters(ARMED), before == READY && arm_turned && hazard == 0 && stop == 0 && step == 0);
  implies(before == TRIP && mode == SAFE, reset_turned && zero && home && hazard == 0 && stop == 0);
  implies(before == TRIP, mode == TRIP || mode == SAFE || mode == LOCK);
  implies(before == LOCK, mode == LOCK);
  implies(mode == SAFE || mode == READY || mode == ARMED, zero);
  implies(hot(before) && mode == TRIP, epoch_raised);
  implies(mode == HOLD || mode == RETRACT, falls);
  implies(before == HOLD && mode == ACTIVE && was_done && confirms, depth_check == 1);
  implies(step != step_before, mode == ARMED || (before == HOLD && mode == ACTIVE && was_done));
  implies(mode == ACTIVE, step < 3);
  implies(before == ACTIVE && step_reached, mode != ACTIVE);
  implies(before == ACTIVE && (motion == 4 || motion >= 6), mode != ACTIVE);
  implies(before == BOOT && mode == SAFE, self_test == 2);
  implies(hazard == 4 && !hot(before), mode == LOCK);
  implies((hazard == 2 || stop == 2) && !wanted_c0 && (before == ACTIVE || before == HOLD), mode == RETRACT);
  assert(is_enabled == hot(mode));
  assert(seq_raised && spent)
}

init {
  c_code { spin_start(); };
  do
  :: atomic { choose(); tick(); check() }
  od
}

/* Run 2 only. A mode that time ends does end, whatever people and sensors do. */
ltl lock_absorbs { [] ((mode == LOCK) -> [] (mode == LOCK)) }
ltl boot_ends { <> (mode != BOOT) }
ltl armed_ends { [] ((mode == ARMED) -> <> (mode != ARMED)) }
ltl hold_ends { [] ((mode == HOLD) -> <> (mode != HOLD)) }
ltl retract_ends { [] ((mode == RETRACT) -> <> (mode != RETRACT)) }
ltl trip_stays_until_reset { [] ((mode == TRIP) -> ((mode == TRIP) W (reset_turned || mode == LOCK))) }
ltl no_rise_before_arming { (!may_rise) W arm_turned }
ltl off_after_a_trip_until_armed { [] ((mode == TRIP) -> ((!is_enabled) W arm_turned)) }
