"""Client of the drillsweep service: parametric sweeps of nonlinear drillstring dynamics.

    from drillsweep import Client, Range

    client = Client("http://127.0.0.1:7340")
    sweep = client.submit("paper-200m", axes={"flow_rate": [0.01, 0.04], "mud_density": Range(1200, 2100, 4)})
    table = sweep.wait().table().to_pandas()
    orbit = sweep.point(1).orbit(depth=57.7, time=(40, 60))

All quantities are in SI units, which `Table.units` lists. `quantity` describes a column, with its units in pictures and
in the oil field: `quantity("flow_rate").field.of(0.04)` is 634 gpm.
With `drillsweep[pint]` values may be quantities of pint, and `Table.to_pint` and `Quantity.to_pint` return them.

The logger `drillsweep` logs submissions, waits and retries at the level INFO.
"""

from importlib.metadata import version

from drillsweep.client import Client
from drillsweep.design import Axis, Design, Range
from drillsweep.point import Point, PointError
from drillsweep.problem import (
    Conflict,
    ConnectionError,
    DrillsweepError,
    DrillsweepWarning,
    FieldProblem,
    Forbidden,
    IdempotencyKeyReused,
    InvalidRequest,
    NoResult,
    NotFound,
    PreconditionFailed,
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
from drillsweep.values import Value

__version__ = version("drillsweep")

__all__ = [
    "Accuracy",
    "Axis",
    "Cache",
    "Client",
    "Conflict",
    "ConnectionError",
    "Counts",
    "Design",
    "DrillsweepError",
    "DrillsweepWarning",
    "FieldProblem",
    "Forbidden",
    "IdempotencyKeyReused",
    "InvalidRequest",
    "NoResult",
    "NotFound",
    "Outputs",
    "Plan",
    "PlannedPoint",
    "Point",
    "PointError",
    "PreconditionFailed",
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
    "Value",
    "__version__",
    "quantity",
]
