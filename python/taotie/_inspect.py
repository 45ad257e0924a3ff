"""The content of a model file, and its defects."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any, overload

from . import _taotie
from ._arrays import PathLike
from ._native import HasModel, native_model


class _Report(Mapping[str, Any]):
    """A report on a model whose keys are also attributes."""

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
        return f"<taotie.{type(self).__name__} {', '.join(self._data)}>"

    def to_dict(self) -> dict[str, Any]:
        """Return the report as plain data.

        Examples
        --------
        >>> text = json.dumps(tt.inspect(scan).to_dict())
        """
        return dict(self._data)


class Inspection(_Report):
    """A model's content and defects: a mapping as printed by ``taotie inspect --json``; keys are attributes.

    Examples
    --------
    >>> found = tt.inspect(scan)
    >>> found.format, found["format"], len(found.materials)
    ('PLY', 'PLY', 1)
    """


class Audit(_Report):
    """The result of an audit: a mapping as printed by ``taotie inspect --audit --json``; keys are attributes.

    ``passed`` is true if no check failed. ``checks`` has a dict for each check: ``name``, ``status`` (``pass``, ``fail``
    or ``not-tested``), ``message``, and ``value``, ``minimum`` and ``maximum``, which may be ``None``.

    Examples
    --------
    >>> with open("schema.json", "w") as file:
    ...     count = file.write('{"version": "1.0.4", "model": {"triangles": {"maximum": 100}}}')
    >>> tt.inspect(scan, audit="schema.json").passed
    False
    """

    def __repr__(self) -> str:
        failed = [check["name"] for check in self["checks"] if check["status"] == "fail"]
        return f"<taotie.Audit {'failed: ' + ', '.join(failed) if failed else 'passed'}>"


def inspection(native: _taotie.Model) -> Inspection:
    """Return the content of a native model and its defects."""
    return Inspection(json.loads(native.inspection()))


@overload
def inspect(model: PathLike | HasModel) -> Inspection: ...


@overload
def inspect(model: PathLike | HasModel, *, audit: PathLike, product_info: PathLike | None = None) -> Audit: ...


def inspect(
    model: PathLike | HasModel, *, audit: PathLike | None = None, product_info: PathLike | None = None
) -> Inspection | Audit:
    """List the content and the defects of a model file, or check it against an auditor's schema.

    Parameters
    ----------
    model : path or Model
        The model.
    audit : path, optional
        A JSON schema of the Khronos glTF Asset Auditor. The model is checked against it instead.
    product_info : path, optional
        The dimensions of the product that the model shows, as JSON in the auditor's format. Needs ``audit``.

    Returns
    -------
    Inspection or Audit

    Raises
    ------
    Error
        If a file cannot be read, or the schema has a key or a value that the auditor does not know.

    Examples
    --------
    >>> tt.inspect("scan.ply").format
    'PLY'
    """
    if audit is not None:
        return Audit(json.loads(native_model(model).audit(audit, product_info)))
    if product_info is not None:
        raise TypeError("product_info needs audit, the schema to check the model against")
    return inspection(native_model(model))
