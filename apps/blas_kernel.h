#pragma once

namespace flatspeckle::apps {

/// OpenBLAS picks its kernels while it is loaded, by the processors that were known when it was
/// made; on younger ones it falls back on its oldest, which take two to three times as long. There
/// this starts the program once more, with the environment variable OPENBLAS_CORETYPE set by what
/// the processor can do. So it does with OPENBLAS_NUM_THREADS = 1 where the address space is
/// limited (ulimit -v): the threads that OpenBLAS starts wait for ever where there is none for
/// their buffers. Variables that are set stay.
void prepare_blas(char** argv);

}  // namespace flatspeckle::apps
