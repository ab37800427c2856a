#pragma once

#include "core/keys/keys.h"
#include "core/numbers/random.h"
#include "grin/media/scattering/phase_function.h"

// A phase function in space is a file with: the phase function, which has density(cosine), per
// steradian, one_minus_cosine(random) of a turn drawn from it, and mean_cosine(); its values (or
// itself, where numbers are all it needs), with the word of the key `phase` for it;
// add_keys(keys, values, prefix); and make_phase(keys, values), which throws InputError. It is
// listed in space_phases.h.
