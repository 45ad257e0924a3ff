"""Whole processes from start to a written picture."""

import os
import statistics
import tempfile

import cases
import measure

FRESH, KEPT = "fresh", "kept"
# Participants that take more seconds are timed once per kind.
LONG = 5.0


def environment(home, own):
    """The environment variables of this process, with all caches below `home`."""
    variables = {name: value for name, value in os.environ.items() if not name.startswith("XDG_CACHE")}
    for name in ("TAOTIE_CACHE_DIR", "MESA_SHADER_CACHE_DIR", "DRJIT_CACHE_DIR"):
        variables.pop(name, None)
    return variables | own | {"HOME": home}


class Cold:
    """Seconds and MiB of each participant, in turn: first with fresh caches every time, then with caches kept."""

    def __init__(self, scene, pictures, rounds, say):
        self.scene, self.pictures, self.rounds, self.say = scene, pictures, rounds, say
        self.runs = {}  # by shading, name and kind

    def measure(self, some, shading):
        some = [one for one in some if shading in one.shadings]
        with tempfile.TemporaryDirectory() as kept:
            for kind in (FRESH, KEPT):
                for number in range(self.rounds):
                    for one in some:
                        if kind == KEPT or number == 0:
                            home = os.path.join(kept, one.name)
                            os.makedirs(home, exist_ok=True)
                            self.once(one, shading, kind, number, home)
                        else:
                            with tempfile.TemporaryDirectory() as home:
                                self.once(one, shading, kind, number, home)

    def once(self, one, shading, kind, number, home):
        runs = self.runs.setdefault((shading, one.name, kind), [])
        if len(runs) < number or (runs and runs[0].seconds > LONG):
            return
        path = os.path.join(self.pictures, f"cold-{shading}-{one.name}.png")
        command = one.cold(self.scene, cases.COLD_MESH, shading, *cases.COLD_SIZE, path)
        try:
            run = measure.run(command, environment(home, one.environment))
        except measure.Failed as failed:
            self.say(f"cold {one.name}: {str(failed).strip().splitlines()[-1]}")
            return
        runs.append(run)
        self.say(f"cold {shading:14} {one.name:12} {kind:5} {run.seconds:6.2f} s {run.mib:6.0f} MiB")

    def median(self, shading, name, kind):
        """Seconds and MiB, or None."""
        runs = self.runs.get((shading, name, kind))
        if not runs:
            return None
        return statistics.median(run.seconds for run in runs), statistics.median(run.mib for run in runs)
