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

        interrupt.unwind()
        cli.main()
    except PermissionError as error:
        sys.exit(f"{error.filename}: {error.strerror}")
    finally:
        if interrupt.asked():  # whatever has become of it on its way here
            sys.exit(interrupt.STATUS)


if __name__ == "__main__":
    main()
