"""Messages to the user."""


class Problem(Exception):
    """Ends the work with a message in Blender's report."""


def text_of(error):
    """Returns the message of any exception; those of Blender's operators start with `Error: `."""
    return str(error).removeprefix("Error: ").strip() or type(error).__name__
