"""Mitsuba 3 with an LLVM that it can use: `from mitsuba_found import mi`."""

import glob
import os

# The newest LLVM that Debian has; the loader of its own finds older ones, which abort.
LIBRARIES = sorted(glob.glob("/usr/lib/*/libLLVM.so.*") + glob.glob("/usr/lib/llvm-1[789]/lib/libLLVM.so*"))
if LIBRARIES:
    os.environ.setdefault("DRJIT_LIBLLVM_PATH", LIBRARIES[-1])

import mitsuba as mi

__all__ = ["mi"]
