"""The machine of a measurement."""

import os
import platform
import subprocess


def described(program):
    """CPU, cores, memory, system and the version of the program, as one phrase."""
    gib = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    version = _printed([program, "--version"])
    system = f"{platform.system()}, Python {platform.python_version()}"
    return f"{processor()}, {cores()} cores, {gib:.0f} GiB; {system}; {version}"


def cores():
    """The number of cores available to this process."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()


def processor():
    """The CPU's brand name, with its family if a virtual machine hides its number; or at least its architecture."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            said = [line.split(":", 1) for line in file if ":" in line]
    except OSError:
        said = []
    facts = {key.strip(): value.strip() for key, value in said}
    if "model name" in facts:
        name, family = facts["model name"], facts.get("cpu family")
        is_numbered = any(letter.isdigit() for letter in name)
        return name if is_numbered or family is None else f"{name} (family {family})"
    return _printed(["sysctl", "-n", "machdep.cpu.brand_string"]) or platform.machine()


def _printed(command):
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return ""
