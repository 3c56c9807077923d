"""Analog laws of the 1974 report: gains on states by recursion (22), and their schedule over the settings of the feel."""
