"""The complex parts of a scan, where height-maps that overlap fail, as a mesh of their own (paper 7)."""

from stepfield.complex_parts.build import build_complex_parts
from stepfield.complex_parts.parts import ComplexParts, without

__all__ = ["ComplexParts", "build_complex_parts", "without"]
