"""Results as pictures: arrays for the 3-D views, the map, the profile and the histogram. Pure numpy, no Qt.

Everything here takes frozen values of the core and returns read-only arrays, so it may run on any thread.
"""
