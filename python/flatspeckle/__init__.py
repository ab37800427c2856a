"""flatspeckle from Python: one function for each subcommand of the program, with the same keys.

    import flatspeckle as fs
    curve = fs.covariance(domain="slab", depth=1000, scatterer="hg", g=0.9, optical_depth=4,
                          covariance="memory_effect", tilts=[0, 1e-4, 2e-4, 4e-4])
    curve.field_correlation.plot()

Results are xarray.Datasets. The functions are generated from the program's table of keys when they are first used;
help(fs.covariance) lists the keys."""

from flatspeckle import cache, plots
from flatspeckle.errors import InputError, TargetMissed
from flatspeckle.functions import function_of, subcommands
from flatspeckle.result import group, read
from flatspeckle.scene import Scene

__version__ = "0.3.0"
__all__ = ["InputError", "Scene", "TargetMissed", "cache", "group", "plots", "read"]


def __getattr__(name):
    if not name.startswith("_") and name in subcommands():
        return function_of(name)
    raise AttributeError(f"module 'flatspeckle' has no attribute {name!r}")


def __dir__():
    return [*globals(), *subcommands()]
