"""Open3D in a process of its own: scenes and cameras in, frames out."""
