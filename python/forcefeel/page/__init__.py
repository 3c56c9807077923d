"""The kit of every page and output folder: plots, tables, type, colors, templates, and writing that is whole or not at all."""
