"""Messages and stubs of the service, generated from proto/ballpiston/v1 when the package is built."""
