"""The report of `taotie inspect` for a model."""

import json

import measure


def of(program, path):
    return report([program], path)


def report(words, path):
    """The report by a program that takes several words to run."""
    return json.loads(measure.run([*words, "inspect", path, "--json"]).output)


def triangles(program, path):
    return of(program, path)["counts"]["triangles_drawn"]
