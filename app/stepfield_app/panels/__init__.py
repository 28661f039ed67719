"""Panels around the views: parameters, cleaning, layers, fidelity, history."""
