"""What a model file holds and what is wrong with it."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

from ._arrays import PathLike
from ._model import Model
from ._model import model as a_model


class Inspection(Mapping[str, Any]):
    """A report on a model: a mapping as ``taotie inspect --json`` prints it, whose keys are attributes too."""

    def __init__(self, data: dict[str, Any]) -> None:
        self._data = data

    def __getitem__(self, key: str) -> Any:
        return self._data[key]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name not in self._data:
            raise AttributeError(name)
        return self._data[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._data)

    def __len__(self) -> int:
        return len(self._data)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._data]

    def __repr__(self) -> str:
        return f"<taotie.Inspection {', '.join(self._data)}>"

    def to_dict(self) -> dict[str, Any]:
        """Return the report as plain data."""
        return dict(self._data)


def inspection(model: Model) -> Inspection:
    """Return what a model holds and what is wrong with it."""
    return Inspection(json.loads(model._native.inspection()))


def inspect(model: PathLike | Model) -> Inspection:
    """List the content of a model file and its defects.

    Parameters
    ----------
    model : path or Model
        The model.

    Returns
    -------
    Inspection
    """
    return inspection(a_model(model))
