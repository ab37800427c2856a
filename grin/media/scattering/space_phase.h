#pragma once

#include "core/keys/keys.h"
#include "core/numbers/random.h"
#include "grin/media/scattering/phase_function.h"

// Each phase function in space (3D) has its own header. It declares the class of the phase
// function, with density(cosine) per steradian, one_minus_cosine(random), which samples a
// scattering angle, and mean_cosine(); a struct of scene keys (or the class itself, if it contains
// only numbers) with the name of the phase function in the key `phase` (word); add_keys(keys,
// values, prefix); and make_phase(keys, values), which throws InputError. space_phases.h lists all
// phase functions.
