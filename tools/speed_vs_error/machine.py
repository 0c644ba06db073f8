"""The machine on which a sweep ran, for its report."""

import os
import subprocess
from pathlib import Path

from settings import ROOT


def machine_of():
    def output(*command):
        pipe = {"stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
        return subprocess.run(command, **pipe, text=True, check=False).stdout.strip()

    processor = next((line.split(":")[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines()
                      if line.startswith("model name")), "unknown processor")
    return {
        "processor": processor,
        "processors": os.cpu_count(),
        "load": os.getloadavg()[0],
        "compiler": output("c++", "--version").splitlines()[0] if output("c++", "--version") else "unknown compiler",
        "git": output("git", "-C", str(ROOT), "describe", "--always", "--dirty") or "unknown",
    }


def machine_line(machine):
    return (f"{machine['processor']}, {machine['processors']} processors, load {machine['load']:.1f} when the report "
            f"was written; {machine['compiler']}; commit {machine['git']}.")
