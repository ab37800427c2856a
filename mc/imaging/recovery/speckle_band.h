#pragma once

#include <span>

namespace flatspeckle::mc {

/// Speckle of light from an even band of directions: its autocorrelation is sinc^2(band lag), whose
/// power spectrum is a triangle that ends at `band` cycles per pixel.

/// Autocorrelation of unit variance at a lag in pixels.
double speckle_peak(double lag, double band);
/// Power of unit variance at a frequency in cycles per pixel, folded where pixels are too coarse.
double speckle_power(double frequency, double band);
/// Pixels of a grain: sum over all lags of the square of the autocorrelation, by which averages
/// over a frame get better; 2 / (3 band) where grains are larger than pixels.
double grain_of(double band);

/// The band whose peak about lag 0 has most of an autocorrelation in it, and at least half of its
/// height; 0 where nothing has. Speckle of few paths has a wide base besides. noise: standard
/// deviation at any lag but 0; there the variance is larger by 2 + white, where white is the
/// variance of the camera's photons over the square of their mean (Poisson's distribution).
double fitted_band(std::span<const double> autocorrelation, double noise, double white = 0);

}  // namespace flatspeckle::mc
