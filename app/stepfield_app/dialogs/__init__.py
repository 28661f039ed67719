"""Dialogs: what needs a decision or a look, and then goes away."""
