"""What a campaign costs, and how far it is: work in particle-steps, time from the speed of what has been run."""

import math
import sys
import time


def particles_of(scene):
    """Particles that fill the channel; a dry start comes up to them once the water has reached the end."""
    channel, spacing = scene["channel"], scene["fluid"]["particle_spacing_m"]
    length, width = (channel[f"{axis}_max_m"] - channel[f"{axis}_min_m"] for axis in "xz")
    return round(length * width * channel["depth_m"] / spacing**3)


def steps_in_a_frame(scene):
    """Time steps of the solver in a frame, by the rules of /fluid/cfl for water that runs at v_F; 1 for given water."""
    fluid, channel = scene["fluid"], scene["channel"]
    if fluid["model"] != "dfsph":
        return 1
    v = channel["velocity_m_s"]
    wave = math.sqrt(scene["world"]["gravity_m_s2"] * channel["depth_m"])
    rate = max((v + wave) / fluid["cfl"], wave / 0.5, v / 0.4) / fluid["particle_spacing_m"]
    return max(1, math.ceil(rate / scene["frame_rate_hz"]))


def most_work(scene):
    """Particle-steps of a water that is run to the end of its scene; it ends before when nobody is left in it."""
    frames = round(scene["duration_s"] * scene["frame_rate_hz"])
    return particles_of(scene) * steps_in_a_frame(scene) * frames


def work_done(outcome):
    """Particle-steps of a run; given water counts each particle once a frame."""
    steps = outcome["fluid"]["particle_steps"]
    return steps if steps is not None else outcome["frames"] * outcome["fluid"]["particles_max"]


def in_millions(work):
    return f"{work / 1e6:,.0f} M particle-steps"


def duration(seconds):
    """"45 s", "12 min", "3 h 05 min"."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 90 else f"{minutes // 60} h {minutes % 60:02d} min"


class Progress:
    """Tells on stderr what is ahead and how long it will take at most. Solved and given water have each their speed."""

    def __init__(self, clock=time.monotonic, stream=None):
        self.clock, self.stream = clock, stream or sys.stderr
        self.ahead = {}  # water: (crowds, most particle-steps, model)
        self.waters = 0
        self.began = clock()
        self.speed = {}  # of a model: (particle-steps, s) so far

    def say(self, text):
        print(text, file=self.stream, flush=True)

    def plan(self, waters):
        """waters: {key: (crowds still to be run, most particle-steps, model)} in their order."""
        self.ahead, self.waters = dict(waters), len(waters)
        for key, (crowds, work, model) in self.ahead.items():
            self.say(f"ahead: {key}: {crowds} crowds, {model}, at most {in_millions(work)}")
        if self.ahead:
            crowds = sum(crowds for crowds, _, _ in self.ahead.values())
            solved = sum(work for _, work, model in self.ahead.values() if model == "dfsph")
            self.say(f"ahead: {self.waters} waters, {crowds} crowds; to be solved at most {in_millions(solved)}")

    def finished(self, key, work, seconds):
        """A water of the plan is over, with so much work in so many seconds of wall time."""
        if key not in self.ahead:
            return
        model = self.ahead.pop(key)[2]
        old_work, old_seconds = self.speed.get(model, (0, 0))
        self.speed[model] = old_work + work, old_seconds + seconds
        done = f"{self.waters - len(self.ahead)} of {self.waters} waters in {duration(self.clock() - self.began)}"
        rate = f"{work / seconds / 1e6:.2f} M particle-steps/s" if seconds > 0 else "at once"
        self.say(f"{key}: {in_millions(work)} in {duration(seconds)} ({rate}); {done}{self.to_go()}")

    def to_go(self):
        """", at most 12 min to go", as far as a speed is known; "" at the end."""
        if not self.ahead:
            return ""
        known = [(work, model) for _, work, model in self.ahead.values() if self.speed.get(model, (0, 0))[0] > 0]
        seconds = sum(work * self.speed[model][1] / self.speed[model][0] for work, model in known)
        unknown = len(self.ahead) - len(known)
        rest = f" and {unknown} waters of a kind not yet run" if unknown else ""
        return f", at most {duration(seconds)}{rest} to go"
