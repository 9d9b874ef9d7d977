"""Client of the drillsweep service: parametric sweeps of nonlinear drillstring dynamics.

    from drillsweep import Client, Range

    client = Client("http://127.0.0.1:7340")
    sweep = client.submit("paper-200m", axes={"flow_rate": [0.01, 0.04], "mud_density": Range(1200, 2100, 4)})
    table = sweep.wait().table().to_pandas()
    orbit = sweep.point(1).orbit(depth=57.7, time=(40, 60))

All quantities are in SI units; `Table.units` says which, and `quantity` what a column is, and in which units it is
shown and read in the oil field: `quantity("flow_rate").field.of(0.04)` is 634 gpm.

The logger `drillsweep` has submissions, waits and retries, at the level INFO.
"""

from importlib.metadata import version

from drillsweep.client import Client
from drillsweep.design import Axis, Design, Range
from drillsweep.point import Point, PointError
from drillsweep.problem import (
    ChangedMeanwhile,
    Conflict,
    DrillsweepError,
    DrillsweepWarning,
    FieldProblem,
    Forbidden,
    IdempotencyKeyReused,
    InvalidRequest,
    NoAnswer,
    NoResult,
    NotFound,
    Problem,
    RateLimited,
    Unauthorized,
    Unavailable,
    UnsupportedServer,
)
from drillsweep.quantity import Quantity, Unit, quantity
from drillsweep.request import Accuracy, Cache, Outputs
from drillsweep.sweep import Counts, Plan, PlannedPoint, Sweep
from drillsweep.table import Table

__version__ = version("drillsweep")

__all__ = [
    "Accuracy",
    "Axis",
    "Cache",
    "ChangedMeanwhile",
    "Client",
    "Conflict",
    "Counts",
    "Design",
    "DrillsweepError",
    "DrillsweepWarning",
    "FieldProblem",
    "Forbidden",
    "IdempotencyKeyReused",
    "InvalidRequest",
    "NoAnswer",
    "NoResult",
    "NotFound",
    "Outputs",
    "Plan",
    "PlannedPoint",
    "Point",
    "PointError",
    "Problem",
    "Quantity",
    "Range",
    "RateLimited",
    "Sweep",
    "Table",
    "Unauthorized",
    "Unavailable",
    "Unit",
    "UnsupportedServer",
    "__version__",
    "quantity",
]
