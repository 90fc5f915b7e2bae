"""Strips of columns that solve every window once."""

from dataclasses import replace

from cosim import main
from strip_columns import StripColumns


class Once(StripColumns):
    """Cannot go back."""

    models = tuple(replace(model, rewinds=False) for model in StripColumns.models)


main(Once)
