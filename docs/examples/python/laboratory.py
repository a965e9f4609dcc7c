"""A laboratory's records against a model: what is the model missing?"""
import numpy as np

import biopsy

folder, runs = "docs/examples/gap", []
for name, grams in [("ramp-50g", 50), ("staircase-20g", 20), ("dc-80g", 80)]:
    table = np.genfromtxt(f"{folder}/{name}.csv", delimiter=",", names=True)
    runs.append(biopsy.Run(table["voltage_V"], table["displacement_mm"], period_s=0.01, weight_g=grams, name=name))
print(biopsy.gap(biopsy.read_model(f"{folder}/stage.toml"), runs, sensor_noise_mm=0.01).sentence)
