"""What drives a loader: one type of law, made by a design, by hand, or read from its file."""
