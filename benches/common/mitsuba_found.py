"""Mitsuba 3 with a compatible LLVM: `from mitsuba_found import mi`."""

import glob
import os

# The newest LLVM in Debian; Mitsuba's own loader finds older ones, which abort.
LIBRARIES = sorted(glob.glob("/usr/lib/*/libLLVM.so.*") + glob.glob("/usr/lib/llvm-1[789]/lib/libLLVM.so*"))
if LIBRARIES:
    os.environ.setdefault("DRJIT_LIBLLVM_PATH", LIBRARIES[-1])

import mitsuba as mi

__all__ = ["mi"]
