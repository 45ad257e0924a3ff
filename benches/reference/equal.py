"""Rows of the summary: the time until Mitsuba's error equals that of Taotie's images."""

from rows import Row

# The numbers of paths of Taotie's images.
EQUAL_TO = (64, 256)


def rows(result):
    return [row for paths in EQUAL_TO for row in of_paths(result, paths)]


def of_paths(result, paths):
    """A row for each variant of Mitsuba. Errors are those of all rounds; seconds, and the other program's curve, are
    those of each round."""
    _, error = result.curves["taotie"].point(paths)
    rounds = result.curves["taotie"].rounds()
    own = [curve.point(paths)[0] for curve in rounds]
    title = f"path tracing, {result.stage.scene.name}, error of {paths} paths"
    found = []
    for program in result.programs[1:]:
        other = [curve.seconds_to(error) for curve in result.curves[program.name].rounds()]
        load = result.watch.share("taotie", program.name)
        found.append(Row(title, program.title, "s", own, other, None, load))
    return found
