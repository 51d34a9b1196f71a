"""The figures, one module each.

    import ballpiston
    from ballpiston.figures import relaxation

    data = relaxation.measure(ballpiston.connect(), delta=[0.2, 0.1], samples=20_000)
    data["relaxation-energy"]["value"]     # tables: named columns, NumPy arrays
    relaxation.draw(data)                  # a matplotlib figure

The module of a figure has the name in `ballpiston figure NAME` with underscores. It has:

- a first line that `ballpiston figure --list` prints
- measure(client, *, ...): asks the server and computes; returns the tables by name of file. Those
  of stability and speed_accuracy run programs and take no client. The
  keywords are the flags of `ballpiston figure`, with their defaults without --quick and --full.
- EFFORT, if the figure takes samples: the values of keywords that --quick and --full replace
- draw(tables): the picture

`parts` has what they share. Needs matplotlib.
"""

from pathlib import Path


def names() -> list[str]:
    """The names of all figures, such as "mean-free-time"."""
    modules = Path(__file__).parent.glob("[a-z]*.py")
    return sorted(module.stem.replace("_", "-") for module in modules)
