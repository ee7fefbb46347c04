"""The sea: dispersion, spectra, realizations and the field around a float."""
