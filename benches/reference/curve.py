"""The curve of a program's images with increasing numbers of paths: errors over seconds, and the time to an error."""

import math
import statistics


class Curve:
    """Pairs of seconds and RMSE by the number of paths per pixel."""

    def __init__(self):
        self.taken = {}

    def add(self, paths, seconds, rmse):
        self.taken.setdefault(paths, []).append((seconds, rmse))

    def rounds(self):
        """The curve of each round."""
        curves = []
        for number in range(min(map(len, self.taken.values()))):
            curve = Curve()
            for paths, points in self.taken.items():
                curve.add(paths, *points[number])
            curves.append(curve)
        return curves

    def point(self, paths):
        """The median of the seconds, and the root of the mean square of the errors."""
        seconds, errors = zip(*self.taken[paths])
        return statistics.median(seconds), math.sqrt(statistics.fmean(error * error for error in errors))

    def slope(self):
        """The slope of the error over the paths, both as logarithms: -1/2 for independent random paths."""
        logs = [(math.log(paths), math.log(self.point(paths)[1])) for paths in self.taken]
        return statistics.linear_regression(*zip(*logs)).slope

    def seconds_to(self, error):
        """Seconds until the error is at most this: interpolated linearly between logarithms, and beyond the ends with the
        slope of random sampling, by which half the error takes four times as long."""
        points = sorted(map(self.point, self.taken))
        for (early, large), (late, small) in zip(points, points[1:]):
            if small <= error <= large:
                share = math.log(large / error) / math.log(large / small)
                return early * (late / early) ** share
        seconds, nearest = points[0] if error > points[0][1] else points[-1]
        return seconds * (nearest / error) ** 2
