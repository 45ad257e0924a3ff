"""Messages to the user."""


class Problem(Exception):
    """Ends the work with a message in Blender's report."""
