"""Pictures of results on Matplotlib axes, for scripts and notebooks; the pages have their own."""
