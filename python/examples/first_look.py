# %% [markdown]
# A first look at the results of `squeal stability`. Runs as a script, and cell by cell as a notebook:
# `python python/examples/first_look.py results/demo`

# %%
import sys

import squeal

results = squeal.read_results(sys.argv[1] if len(sys.argv) > 1 else "results/demo")
print(results.about["title"], "-", results.about["nodes"], "nodes")

# %% Which modes are unstable, and where
frame = results.modes()
unstable = frame[frame.unstable]
print(unstable[["friction", "mode", "frequency", "growth_rate"]].to_string(index=False))

# %% Friction values at which modes become unstable
for point in results.hopf:
    print({name: value for name, value in point.items() if not isinstance(value, dict)})

# %% Branches that pass a Hopf point: one line a branch
for branch, points in results.branches().groupby("branch"):
    if branch in {point["branch"] for point in results.hopf}:
        print(f"branch {branch}: {points.frequency.iloc[0]:.0f} Hz, largest growth rate {points.growth_rate.max():.1f} 1/s")

# %% The shape of the strongest mode on the surface of the brake, where pyvista is installed
value = max((v for v in results.values if v.modes.shapes), key=lambda v: v.modes.growth_rate.max(), default=None)
try:
    import pyvista

    if value is not None:
        mode = max(value.modes.shapes, key=lambda i: value.modes.growth_rate[i])
        extent = results.nodes.max() - results.nodes.min()
        results.shape_mesh(value, mode, scale=0.02 * extent).save("mode.vtp")
        print("mode.vtp written, pyvista", pyvista.__version__)
except ImportError:
    print("pyvista is not installed: no shape")
