"""Modules shared by the plot scripts, which are in the folder above."""
