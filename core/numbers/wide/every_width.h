#pragma once

/// Attribute of a function that contains vectorisable loops. The function is compiled for several
/// vector widths, and all calls in it are inlined; at its start the program selects the widest that
/// the processor supports. It is compiled for one width only if the compiler cannot do this or is
/// given a target processor.
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__clang__) && !defined(__AVX2__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define FLATSPECKLE_EVERY_WIDTH \
  [[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"), gnu::flatten]]
#else
#define FLATSPECKLE_EVERY_WIDTH [[gnu::flatten]]
#endif
