"""python -m pipeline ..., and the command `study`."""

from pipeline import environment


def main() -> None:
    """The environment first: BLAS reads its number of threads once, when numpy is imported."""
    environment.prepare()
    from pipeline.cli import cli

    cli.main()


if __name__ == "__main__":
    main()
