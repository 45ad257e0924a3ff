"""Scenes of several models."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from . import _taotie
from ._arrays import affine
from ._error import invalid_type
from ._model import Model, model as a_model


class Scene(Model):
    """A model of several models, each placed by a transform, with their materials, lights and cameras.

    Parameters
    ----------
    objects : iterable
        Models: paths, `Model`, `Asset`, or meshes of other packages; or pairs of one with its transform, ``(4, 4)``,
        array_like, from the object to the world, for column vectors. A model that occurs several times is stored once.

    Raises
    ------
    Error
        If a transform is not affine and finite, or a model cannot be read.

    Examples
    --------
    >>> aside = np.eye(4)
    >>> aside[0, 3] = 3
    >>> pair = tt.Scene([scan, (asset, aside)])
    >>> pair.triangles == scan.triangles + asset.triangles[0]
    True
    >>> image = tt.render(pair, size=32)
    """

    def __init__(self, objects: Iterable[Union[Any, tuple[Any, npt.ArrayLike]]]) -> None:
        if isinstance(objects, (str, bytes, Model)) or not isinstance(objects, Iterable):
            raise invalid_type("objects", objects, "a sequence of models, or of pairs of a model and its transform")
        models: dict[int, Any] = {}
        parts = []
        for thing in objects:
            given, transform = thing if isinstance(thing, tuple) and len(thing) == 2 else (thing, np.eye(4))
            if id(given) not in models:
                # The object is kept, so that no other one gets its identity.
                models[id(given)] = (given, a_model(given)._native)
            parts.append((models[id(given)][1], affine("transform", transform).T.tolist()))
        super().__init__(_taotie.join(parts))
