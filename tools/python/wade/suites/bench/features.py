"""What a feature costs: processor time of the programs with it, over that without it, in pairs of runs that take turns.

`off` sets the feature to what it is without a word (the viscosity to 0, where it is 0.01 without), so that its ratio shows how
exactly this machine can tell; `on` uses it.
The programs are the same throughout: a feature that is off is a test a step.
"""

import os
import secrets
import subprocess
import tempfile
import time
from pathlib import Path

from wade.paths import BUILD, ROOT
from wade.reports.files import complain, say
RIVER = "configs/bench/river.json"  # 21,600 particles, water alone
CROWD = "configs/observed/agents_500.json"  # cheap water, so that the crowd counts

BLOCK = '[{"x_min_m": 48, "x_max_m": 52, "z_min_m": 11, "z_max_m": 15, "height_m": 2}]'
RAGDOLL = '/crowd/ragdoll={"condition": "depth_speed"}'

# Name, scene, simulated seconds, whose time counts, variants: name -> (arguments, programs beside).
FEATURES = (
    ("viscosity", RIVER, 3, ("server",), {
        "off": (["--set", "/fluid/viscosity_m2_s=0"], ()),
        "on": (["--set", "/fluid/viscosity_m2_s=1e-3"], ()),
    }),
    ("obstacles", RIVER, 3, ("server",), {
        "off": (["--set", "/obstacles=[]"], ()),
        "on": (["--set", "/obstacles=" + BLOCK], ()),
    }),
    ("agents_stream", CROWD, 10, ("server", "client"), {
        "off": (["--set", "/coupling/agents_stream=off"], ()),
        "on": (["--set", "/coupling/agents_stream=parallel"], ()),
    }),
    ("recording", CROWD, 10, ("server", "client"), {"off": ([], ()), "on": ([], ("recorder",))}),
    ("ragdoll", CROWD, 10, ("client",), {
        "off": (["--set", '/crowd/ragdoll={"condition": "off"}'], ()),
        "on": (["--set", RAGDOLL], ()),
    }),
    ("danger_maps", CROWD, 10, ("client",), {
        "off": (["--danger-every-s", "0"], ()),
        "on": (["--danger-every-s", "1"], ()),
    }),
)  # fmt: skip
OF_CLIENT = ("--danger-every-s",)


def start(command, folder, name):
    with open(folder / f"{name}.log", "wb") as log:
        return subprocess.Popen([str(word) for word in command], stdout=log, stderr=log, cwd=folder)


def processor_time(process, name, folder):
    """Seconds, user and system, of a program that must end well."""
    _pid, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise RuntimeError(f"{name}: exit code {process.returncode}: {(folder / f'{name}.log').read_text()[-300:]}")
    return usage.ru_utime + usage.ru_stime


def split(arguments):
    """Those that both programs have, and those of the client."""
    if arguments and arguments[0] in OF_CLIENT:
        return [], arguments
    return arguments, []


def one_run(scene, seconds, counted, variant):
    """Processor time of the programs that count, s, and the particle-steps of the server where it runs alone."""
    arguments, beside = variant
    both, client_only = split(arguments)
    session = f"wade-bench-{os.getpid()}-{secrets.token_hex(3)}"
    common = ["--session", session, "--until-s", seconds, "--threads", 1, *both]
    alone = counted == ("server",)
    with tempfile.TemporaryDirectory(prefix="wade-bench-") as name:
        folder, running = Path(name), {}
        try:
            consumers = 0 if alone else 1 + len(beside)
            running["server"] = start([BUILD / "fluid_server", ROOT / scene, "--consumers", consumers, *common], folder, "server")
            if "recorder" in beside:
                running["recorder"] = start([BUILD / "shm_record", session, folder / "water.rec"], folder, "recorder")
                while not any(folder.glob("water.rec*")) and running["recorder"].poll() is None:
                    time.sleep(0.01)  # it has joined before the crowd, which is not a follower
            if not alone:
                extra = ["--water-every-s", 0, "--out", folder / "run", *client_only]
                running["client"] = start([BUILD / "crowd_client", ROOT / scene, *common, *extra], folder, "client")
            times = {who: processor_time(process, who, folder) for who, process in running.items()}
        finally:
            for process in running.values():
                if process.returncode is None:
                    process.kill()
                    process.wait()
            for kind in ("fluid", "agents"):
                Path(f"/dev/shm/{session}-{kind}").unlink(missing_ok=True)
    return sum(times[who] for who in counted)


def interval_of_median(ratios):
    """Median and an interval round it that holds for any distribution: 95 % from nine pairs on, all of them below."""
    ordered = sorted(ratios)
    n = len(ordered)
    drop = 1 if n >= 9 else 0
    return ordered[n // 2], ordered[drop], ordered[n - 1 - drop]


def measure(wanted, quick, _threads):
    """Results of the features that are wanted, and whether all went well."""
    results, well = [], True
    pairs = 3 if quick else 9
    for feature, scene, seconds, counted, variants in FEATURES:
        for variant, what in variants.items():
            name = f"features/{feature}_{variant}"
            if not wanted(name):
                continue
            ratios, without = [], []
            try:
                for pair in range(pairs):
                    order = [([], ()), what] if pair % 2 == 0 else [what, ([], ())]
                    times = [one_run(scene, seconds, counted, v) for v in order]
                    first, second = times if pair % 2 == 0 else times[::-1]
                    ratios.append(second / first)
                    without.append(first)
            except (RuntimeError, OSError) as error:
                complain(f"bench: {name}: {error}")
                well = False
                continue
            middle, low, high = interval_of_median(ratios)
            say(f"{name:32} {middle:.3f} times the processor time, {low:.3f} to {high:.3f} ({pairs} pairs)")
            results.append({
                "name": name, "size": 0, "threads": 1, "median": middle, "min": low, "max": high, "unit": "times_cpu",
                "pairs": pairs, "cpu_s_without": sorted(without)[pairs // 2], "counted": " + ".join(counted),
            })  # fmt: skip
    return results, well
