#pragma once

namespace flatspeckle::apps {

/// OpenBLAS picks its kernels while it is loaded, by the processors that were known when it was
/// made; on younger ones it falls back on its oldest, which take two to three times as long. There
/// this starts the program once more, with the environment variable OPENBLAS_CORETYPE set by what
/// the processor can do; where it is set already, or the choice is right, this does nothing.
void use_fast_blas(char** argv);

}  // namespace flatspeckle::apps
