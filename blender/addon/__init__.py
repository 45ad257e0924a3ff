"""Taotie for Blender: bakes a high-poly object to a small asset, and shows the measured error on its surface.

It exports objects, runs the program `taotie`, and imports the result. docs/blender.md describes it.
"""

from .panel import register, unregister

__all__ = ["register", "unregister"]
