"""Delay laws by the plain equations of their papers, to hold a sweep against."""
