"""The loader: its file, its parameters and tolerances, its curves, and the built-in ones."""
