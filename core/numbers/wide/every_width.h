#pragma once

/// Before a function of loops that become vectors: it is compiled for several widths, of which the
/// program takes the widest that the processor has when it starts, and all that it calls is made a
/// part of it. Where the compiler cannot, or is told what processor it compiles for, for one.
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__clang__) && !defined(__AVX2__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define FLATSPECKLE_EVERY_WIDTH \
  [[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"), gnu::flatten]]
#else
#define FLATSPECKLE_EVERY_WIDTH [[gnu::flatten]]
#endif
