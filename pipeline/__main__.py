"""python -m pipeline ..., and the command `study`."""

import sys

from pipeline import interrupt


def main() -> None:
    """The environment first: BLAS reads its number of threads once, when numpy is imported."""
    interrupt.heed()
    try:
        from pipeline import environment

        environment.prepare()
        with environment.importing():
            from pipeline.cli import cli

        cli.main()
    except interrupt.Interrupted:
        sys.exit(interrupt.STATUS)
    except PermissionError as error:
        sys.exit(f"{error.filename}: {error.strerror}")


if __name__ == "__main__":
    main()
