"""A sweep over flow rate and mud density: submit, wait, table, pictures of one point. Needs `drillsweep[all]`."""

import matplotlib.pyplot as plt

from drillsweep import Client, Range, plot

client = Client()  # DRILLSWEEP_SERVER, DRILLSWEEP_TOKEN; port 7340 of this machine unless set
sweep = client.submit(
    "paper-200m-damped",
    axes={"flow_rate": [0.01, 0.04, 0.06], "mud_density": Range(1200, 2100, 4)},
    name="flow rate against density",
)
sweep.wait()
for point in sweep.failures():
    print(point, point.error)

table = sweep.table().to_pandas()
print(table[["flow_rate", "mud_density", "friction_coefficient_max", "orbit_radius_rms_57_7m"]].to_string(index=False))

figure, (left, middle, right) = plt.subplots(1, 3, figsize=(15, 5), layout="constrained")
plot.orbit(sweep.point(1), depth=57.7, axes=left)
plot.spectrum(sweep.point(1), depth=57.7, window="hann", axes=middle)
plot.profile(sweep.points(), axes=right)
figure.savefig("sweep.png")
