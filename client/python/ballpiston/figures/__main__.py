"""What `ballpiston figure` starts: python3 -m ballpiston.figures NAME --out DIR ..."""

from __future__ import annotations

import sys

_PACKAGES = {"grpc": "python3-grpcio", "google": "python3-protobuf"}  # else python3-MODULE

if __name__ == "__main__":
    try:
        from ballpiston.figures.parts.command import main
    except ModuleNotFoundError as error:
        module = str(error.name).split(".", maxsplit=1)[0]
        package = _PACKAGES.get(module, f"python3-{module}")
        print(
            f"ballpiston: figures need the module {module} of {sys.executable}: "
            f"install the package {package}",
            file=sys.stderr,
        )
        sys.exit(4)
    except KeyboardInterrupt:
        sys.exit(130)
    sys.exit(main(sys.argv[1:]))
