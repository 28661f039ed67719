"""Views of the data: three of Open3D, the map, the profile and the histogram."""
