"""The machine of a measurement."""

import os
import platform
import subprocess

# The parts of AVX-512 without which Taotie uses AVX2.
AVX512 = {"avx512vl", "avx512_vbmi2", "avx512_bitalg", "avx512_vpopcntdq"}


def described(program):
    """Processor, cores, SIMD level, memory, system and the version of the program, as one phrase."""
    gib = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    version = _printed([program, "--version"])
    system = f"{platform.system()} {platform.release()}, Python {platform.python_version()}"
    level = simd(_facts().get("flags", "").split())
    return f"{processor()}, {cores()} cores, {level}{gib:.0f} GiB; {system}; {version}"


def simd(flags):
    """The widest instructions of an x86 processor that Taotie uses, with a comma; nothing for other processors."""
    for name, needed in (("AVX-512", AVX512), ("AVX2", {"avx2", "fma"}), ("SSE2", {"sse2"})):
        if needed <= {*flags}:
            return f"{name}, "
    return ""


def cores():
    """The number of cores available to this process."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()


def processor():
    """The processor's brand name, which a virtual machine may shorten, with family and model; or its architecture."""
    facts = _facts()
    if "model name" in facts:
        kinds = (("family", "cpu family"), ("model", "model"))
        numbers = [f"{title} {facts[key]}" for title, key in kinds if key in facts]
        return facts["model name"] + (f" ({', '.join(numbers)})" if numbers else "")
    return _printed(["sysctl", "-n", "machdep.cpu.brand_string"]) or platform.machine()


def _facts():
    """The last processor of /proc/cpuinfo; empty without that file."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            said = [line.split(":", 1) for line in file if ":" in line]
    except OSError:
        return {}
    return {key.strip(): value.strip() for key, value in said}


def _printed(command):
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return ""
