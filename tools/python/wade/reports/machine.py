"""What measurements were made on."""

import os
import platform
import subprocess
from pathlib import Path

from wade.paths import ROOT

BUSY = 0.3  # processors that others use; beyond this the figures are worth little


def first_line(path):
    try:
        return Path(path).read_text(encoding="utf-8").splitlines()[0].strip()
    except (OSError, IndexError):
        return None


def cpu_info(key):
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return None
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith(key)), None)


def caches():
    """For example {"L1 Data": "48K", "L2 Unified": "2048K"}."""
    found = {}
    for index in sorted(Path("/sys/devices/system/cpu/cpu0/cache").glob("index*")):
        level, kind, size = (first_line(index / name) for name in ("level", "type", "size"))
        if level and size:
            found[f"L{level} {kind}"] = size
    return found


def vector_width():
    flags = (cpu_info("flags") or "").split()
    return next((name for name in ("avx512f", "avx2", "avx", "sse2") if name in flags), "none")


def processor():
    return cpu_info("model name") or platform.processor() or "unknown processor"


def machine():
    """All that is known, as it goes into results; loads are those of the moment."""
    frequency = cpu_info("cpu MHz")
    return {
        "model": processor(), "processors": os.cpu_count(), "frequency_mhz": float(frequency) if frequency else None,
        "caches": caches(), "vectors": vector_width(),
        "memory_gib": round(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30, 1),
        "system": f"{platform.system()} {platform.release()}",
        "load_at_start": os.getloadavg()[0], "busy": os.getloadavg()[0] > BUSY,
    }


def machine_text(m):
    frequency = f"{m['frequency_mhz']:.0f} MHz, " if m["frequency_mhz"] else ""
    sizes = ", ".join(f"{name} {size}" for name, size in m["caches"].items())
    return (f"{m['model']}, {m['processors']} processors, {frequency}{m['vectors']}, {sizes}, "
            f"{m['memory_gib']} GiB, {m['system']}; load {m['load_at_start']:.2f} at the start")


def machine_line():
    """Processor, load and commit in a line of a report."""
    command = ["git", "-C", ROOT, "describe", "--always", "--dirty"]
    commit = subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip() or "unknown"
    return (f"{processor()}, {os.cpu_count()} processors, load {os.getloadavg()[0]:.1f} when the report was written; "
            f"commit {commit}.")
