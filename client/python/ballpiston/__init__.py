"""Questions to ballpiston, a simulation service for the ball-piston billiard.

    import ballpiston

    client = ballpiston.connect()
    result = client.run("first-hit", rho=0.5296, delta=[0.1, 0.05], epsilon=0.125,
                        exponent=[1, 2], samples=1e5)
    result["mean_hit_time"], result.error("mean_hit_time")
    result.save("first-hit.json")

`connect()` starts the user's private server if none is named. `help(ballpiston.specification)`
lists experiments and parameters with their units and ranges, `help(ballpiston.Result)` what an
answer has. The messages and stubs of the protocol are in ballpiston.v1.
"""

from ballpiston._version import __version__
from ballpiston.client import Client, ServerStatus, connect
from ballpiston.closed_forms import ClosedForms
from ballpiston.collisions import Collisions
from ballpiston.errors import (
    DataLoss,
    DeadlineExceeded,
    Error,
    FailedPrecondition,
    InvalidArgument,
    InvalidSpecification,
    NoPrivateServer,
    NotFound,
    PermissionDenied,
    ResourceExhausted,
    ResultsExpired,
    Unauthenticated,
    Unavailable,
)
from ballpiston.estimates_table import estimates_table
from ballpiston.job import Job, JobCancelled, JobFailed, JobNotSucceeded
from ballpiston.measured_functions import Curve, Histogram
from ballpiston.plan import Plan
from ballpiston.point import Estimate, Point
from ballpiston.result import Result, load
from ballpiston.specification import specification
from ballpiston.watch import Update

__all__ = [
    "Client",
    "ClosedForms",
    "Collisions",
    "Curve",
    "DataLoss",
    "DeadlineExceeded",
    "Error",
    "Estimate",
    "FailedPrecondition",
    "Histogram",
    "InvalidArgument",
    "InvalidSpecification",
    "Job",
    "JobCancelled",
    "JobFailed",
    "JobNotSucceeded",
    "NoPrivateServer",
    "NotFound",
    "PermissionDenied",
    "Plan",
    "Point",
    "ResourceExhausted",
    "Result",
    "ResultsExpired",
    "ServerStatus",
    "Unauthenticated",
    "Unavailable",
    "Update",
    "__version__",
    "connect",
    "estimates_table",
    "load",
    "specification",
]
