// C++'s allocation functions for WebAssembly, whose Rust target has C's standard library but not that of C++.

#include <stdlib.h>

void *operator new(size_t size) {
  void *memory = malloc(size ? size : 1);
  if (!memory) abort();
  return memory;
}

void operator delete(void *memory) noexcept { free(memory); }
