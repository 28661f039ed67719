"""The window of Stepfield: Open3D views, live sliders, layers, maps and profiles."""
