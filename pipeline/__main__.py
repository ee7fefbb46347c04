"""python -m pipeline ..., and the command `study`."""

import sys

from pipeline import environment


def main() -> None:
    """The environment first: BLAS reads its number of threads once, when numpy is imported."""
    try:
        environment.prepare()
    except PermissionError as error:
        sys.exit(f"{error.filename}: {error.strerror}")
    from pipeline import cli

    cli.main()


if __name__ == "__main__":
    main()
