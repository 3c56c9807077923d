"""A law closed on a loader: loops at the command, loops of a sampled law, their margins."""
