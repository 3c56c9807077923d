"""What a command ends with, beside 0, fine."""

BAD_ANSWER = 1
"""Exit status where the answer is bad: an unstable design, a loader that does not qualify."""

BAD_INPUT = 2
"""Exit status where the input is bad."""

FAULT = 70
"""Where forcefeel itself failed: ``EX_SOFTWARE`` of ``sysexits.h``."""

INTERRUPTED = 130
"""After Ctrl-C, as shells have it: 128 and the number of the signal."""

UNREAD = 141
"""Where a reader of the output ends early, as ``head`` does: as shells report a program that SIGPIPE ends, 128 and its number."""
