"""Fitting coefficients: linear least squares, mean forces, waveforms with their harmonics."""
