"""The standard error details (google.rpc) that the service sends.

googleapis-common-protos has them as google.rpc.status_pb2 and google.rpc.error_details_pb2, but not
every system has that package. Both would register the same file names in the one pool of
descriptors of the process, and the pool rejects a second file of the same name with other options.
Therefore this package uses the installed modules if they exist. Otherwise it uses its own copies,
which protoc generates.
"""

from __future__ import annotations

try:
    from google.rpc import status_pb2
except ImportError:
    from ballpiston._google_rpc import status_pb2
try:
    from google.rpc import error_details_pb2
except ImportError:
    from ballpiston._google_rpc import error_details_pb2

__all__ = ["error_details_pb2", "status_pb2"]
