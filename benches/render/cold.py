"""Whole processes from start to a written picture."""

import os
import shutil
import statistics
import tempfile

import cases
import measure
import quiet

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
        self.watches = {}  # the load of other programs by shading and kind

    def measure(self, some, shading):
        if not self.rounds:
            return
        some = [one for one in some if shading in one.shadings]
        with tempfile.TemporaryDirectory() as kept:
            for kind in (FRESH, KEPT):
                runs, watch = quiet.undisturbed(lambda watch: self.turns(some, shading, kind, kept, watch))
                self.watches[shading, kind] = watch
                self.runs |= {(shading, name, kind): its for name, its in runs.items()}

    def turns(self, some, shading, kind, kept, watch):
        """The runs of each participant by name; the last one with fresh caches leaves them in a folder of `kept`."""
        runs = {}
        for number in range(self.rounds):
            for one in some:
                its = runs.setdefault(one.name, [])
                if len(its) < number or (its and its[0].seconds > LONG):
                    continue
                home = os.path.join(kept, one.name)
                if kind == FRESH:
                    shutil.rmtree(home, ignore_errors=True)
                os.makedirs(home, exist_ok=True)
                with watch.turn(one.name):
                    its += self.once(one, shading, kind, home)
        return runs

    def once(self, one, shading, kind, home):
        """A list of one run, or none if it failed."""
        path = os.path.join(self.pictures, f"cold-{shading}-{one.name}.png")
        command = one.cold(self.scene, cases.COLD_MESH, shading, *cases.COLD_SIZE, path)
        try:
            run = measure.run(command, environment(home, one.environment))
        except measure.Failed as failed:
            self.say(f"cold {one.name}: {str(failed).strip().splitlines()[-1]}")
            return []
        self.say(f"cold {shading:14} {one.name:12} {kind:5} {run.seconds:6.2f} s {run.mib:6.0f} MiB")
        return [run]

    def seconds(self, shading, name, kind):
        """The seconds of each run."""
        return [run.seconds for run in self.runs.get((shading, name, kind), [])]

    def mib(self, shading, name):
        """The median memory of the kind of runs that takes more; 0 without any."""
        runs = [self.runs.get((shading, name, kind)) for kind in (FRESH, KEPT)]
        return max((statistics.median(run.mib for run in its) for its in runs if its), default=0)
