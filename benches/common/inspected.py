"""The report of `taotie inspect` for a model."""

import json

import measure


def of(program, path):
    return json.loads(measure.run([program, "inspect", path, "--json"]).output)


def triangles(program, path):
    return of(program, path)["counts"]["triangles_drawn"]
