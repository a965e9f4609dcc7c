"""A controller of one's own under the robot's supervisor and gate, on the simulated stage."""
import biopsy

robot = biopsy.Robot("gap", seed=3)
step = robot.steps[0]
integral_V, seen = 0.0, robot.tick()
for tick in range(15_000):
    error_mm = seen["setpoint_mm"] - seen["depth_mm"] if seen["mode"] == "active" else 0.0
    integral_V = min(max(integral_V + 5.0 * error_mm, 0.0), step["v_max_V"])
    amplitude_V = min(max(integral_V + 800.0 * error_mm, 0.0), step["v_max_V"])
    polarity = 1 if tick % 500 < 250 else -1  # 2 Hz: the films must not charge
    seen = robot.tick(arm=600 < tick < 700, held=tick > 900, voltage_V=polarity * amplitude_V)
    if tick % 1000 == 0:
        print(f"{seen['time_s']:6.2f} s  {seen['mode']:8} {seen['depth_mm']:6.2f} mm  {seen['drive_V'] / 1000:6.2f} kV")
    if seen["step_done"] or seen["mode"] == "trip":
        break
print(f"{seen['mode']}: needle at {seen['depth_mm']:.2f} mm of {step['depth_mm']:.2f} mm; hazard: {seen['hazard']}")
