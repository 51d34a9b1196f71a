"""What `ballpiston figure` starts: python3 -m ballpiston.figures NAME --out DIR ..."""

import sys

from ballpiston.figures.parts.command import main

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
