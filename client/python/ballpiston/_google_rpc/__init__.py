"""The standard error details (google.rpc) that the service sends.

googleapis-common-protos has them as google.rpc, but not every system has that package. The one pool
of descriptors of the process rejects a second file of the same name with other options. So the
installed modules are used if they exist, else this package's own, which protoc generates.
"""

try:
    from google.rpc import status_pb2
except ImportError:
    from ballpiston._google_rpc import status_pb2
try:
    from google.rpc import error_details_pb2
except ImportError:
    from ballpiston._google_rpc import error_details_pb2

__all__ = ["error_details_pb2", "status_pb2"]
