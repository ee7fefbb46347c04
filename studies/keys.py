"""Renew the keys of study files in studies/README.md: python -m studies.keys."""

from pathlib import Path

from pipeline.cli.reference import markdown
from studies.paper import renewed

PAGE = Path(__file__).with_name("README.md")


def page() -> str:
    """The page with the keys that there are."""
    return renewed(PAGE.read_text(), {"keys": markdown()})


if __name__ == "__main__":
    PAGE.write_text(page())
