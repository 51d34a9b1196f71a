"""What `ballpiston figure` starts: python3 -m ballpiston.figures NAME --out DIR ..."""

from __future__ import annotations

import sys

if __name__ == "__main__":
    try:
        from ballpiston.figures.parts.command import main
    except KeyboardInterrupt:
        sys.exit(130)
    sys.exit(main(sys.argv[1:]))
