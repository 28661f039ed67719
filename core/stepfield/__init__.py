"""Stepfield: laser scans of multi-level terrain into layered height-maps for robot simulators."""

__version__ = "0.1.0"
