"""The console of ``forcefeel run``: a web server of this machine, and the page that it serves.

The loop waits for nothing in here: the server asks it for its newest rows sixty times a second, and hands on what is asked of it.
"""
