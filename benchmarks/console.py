"""The console's share of a core and what it costs the loop: eight watchers at 60 frames a second beside a loop at 1 kHz.

Cycles that are missed are reported beside those of the same loop without a console, run right before: a machine without a real-time
kernel misses some by itself. ``python benchmarks/console.py 600`` takes ten minutes of each.
"""

import multiprocessing
import sys
import threading
import time

from websockets.sync.client import connect

import forcefeel as ff

WATCHERS = 8
MOST_SHARE = 0.10
SECONDS = float(sys.argv[1]) if len(sys.argv) > 1 else 20.0


def watch(url: str, token: str, seconds: float, frames) -> None:
    with connect(url, additional_headers={"Authorization": f"Bearer {token}"}, compression=None, proxy=None) as socket:
        end = time.monotonic() + seconds
        count = 0
        while time.monotonic() < end:
            count += isinstance(socket.recv(), bytes)
        frames.put(count)


def loop():
    return ff.live.start(ff.digital_elevator().replace({"controller.period": "1 ms"}), "robust")


def main() -> None:
    with loop() as running:
        time.sleep(SECONDS)
        alone = running.state.missed
    frames, context = multiprocessing.Queue(), multiprocessing.get_context("fork")
    with loop() as running, ff.live.Console(running, port=0) as console:
        token = console.admission.watch
        url = console.watch_address.partition("?")[0].replace("http", "ws") + "live"
        watchers = [context.Process(target=watch, args=(url, token, SECONDS + 3, frames)) for _ in range(WATCHERS)]
        for one in watchers:
            one.start()
        time.sleep(3.0)  # until all are there and the curve is drawn
        (server,) = (it for it in threading.enumerate() if it.name == "forcefeel console")
        clock = time.pthread_getcpuclockid(server.ident)
        before, missed, cycle = time.clock_gettime(clock), running.state.missed, running.state.cycle
        time.sleep(SECONDS - 1)
        used = time.clock_gettime(clock) - before
        share, state = used / (SECONDS - 1), running.state
        for one in watchers:
            one.join()
    each = [frames.get() / (SECONDS + 3) for _ in watchers]
    print(f"{WATCHERS} watchers, {min(each):.1f} to {max(each):.1f} frames/s each, over {SECONDS:g} s")
    print(f"server: {100 * share:.1f} % of a core (at most {100 * MOST_SHARE:g} %)")
    print(f"missed of {state.cycle - cycle} cycles: {state.missed - missed}; of a run alone before it: {alone}")
    sys.exit(share > MOST_SHARE)


if __name__ == "__main__":
    main()
