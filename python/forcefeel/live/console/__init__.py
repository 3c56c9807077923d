"""The console of ``forcefeel run``: a web server and its page.

The loop never waits for the server, which reads its newest rows sixty times a second and forwards requests.
"""
