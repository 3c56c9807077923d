"""Live loop: start, change and observe a loader's loop in a real-time thread from Python.

``start(loader, law=None, *, endpoint=Simulated(), real_time=True, supervised=True, host=None, record=None, record_rate_hz=None,
most_bytes=2**30, ring=False) -> LiveSession``, a context manager: leaving it ends the loop with the drive off and closes the
record. ``host`` is a UDP port for an aircraft simulator, with the packets of ``docs/reference/host.md``. ``endpoint`` is
``Simulated(scenario=None)``, the nonlinear machine in the loop's own thread, ``Udp(address)``, a machine with the packets of
``docs/reference/live.md``, or a drive on a bus, ``loader.bus``.

``LiveSession`` is thread-safe, and only ``wait`` waits for the loop:

``on()``, ``passive()``, ``off()``
    Request the feel; power without feel; no power, which is the initial state.
``stop()``, ``acknowledge()``
    Emergency stop; clear latched trips. Then ``off()`` and ``on()`` restart.
``feel`` (get, set)
    Mapping of ``feel.`` rows, as in ``Loader.replace``; the law follows. New rows are merged and faded in without a bump over
    ``fade_s``; during a fade the newest feel waits.
``loader``, ``law``
    The loader with the current feel, and its law.
``trim_rad``, ``stiffness_factor``, ``shaker`` (get, set)
    The loop approaches these values at a limited rate.
``hand_force_n``, ``hand_angle_rad`` (get, set)
    Simulated machine: force at the grip; angle that the hand holds, ``None`` to release.
``inject_fault(fault, sensor=None, by=0)``, ``clear_faults()``
    Faults of a simulated machine, from ``FAULTS`` and ``SENSORS``.
``state``
    ``State(cycle, time_s, name, trips, missed, silent, lost_rows, recorded, unrecorded_rows, record_ended, ended,
    drive_fault)``;
    name is one of ``STATES``.
``host``
    ``HostState(listens, address, packets, refused, silent_s, share, waiting, softened)``, or ``None``.
``trips``
    Tuple of ``Trip(name, sentence)`` since the last acknowledgment.
``columns``, ``history(since=-1, most=None)``
    Column names with SI units as suffix; array (rows, columns) with a row for each cycle after cycle ``since``, at most the newest
    ``most``. ``cycle`` is a column.
``timing``
    ``Timing(late, work, period_s)``: two ``Histogram(edges_us, counts)`` of wake-up latency and working time.
``wait(cycles, timeout_s)``
    Wait for a number of further cycles.
``realtime_status``
    A sentence each on priority, locked memory and processor sleep.

``start_cockpit(project, law=None, *, endpoints={}, ...) -> LiveCockpit`` runs all axes of a project in a loop: a mapping from
axis to ``LiveSession`` with ``on``, ``off``, ``stop``, ``acknowledge``, ``wait`` of all, ``disconnect`` and ``connect`` of links.

``read_live_record(path)`` returns a record's table; ``replay(path)`` runs it again and compares every bit. ``Machine(loader)`` is
the simulated machine for use in another process; ``BusEmulator(loaders)`` is such machines behind a bus.

Example:
    >>> with ff.live.start(ff.digital_elevator(), "robust", real_time=False) as running:
    ...     running.on()
    ...     running.wait(10_000)
    ...     running.hand_force_n = 50.0
    ...     running.wait(2000)
    ...     angle = running.history()[-1, running.columns.index("column_angle_rad")]
    >>> angle > 0
    True
"""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
