"""Data files that ship with Stepfield: JSON schemas of the files it writes."""
