"""A loader live: the loop in a real-time thread of its own, from Python started, changed and looked at.

``start(loader, law=None, *, over=Simulated(), real_time=True, supervised=True, host=None, record=None, most_bytes=2**30) ->
Running``, a context manager: leaving it ends the loop, its drive off, and closes the record. ``host`` is a UDP port for an aircraft
simulator, with the packets of ``docs/reference/host.md``. ``endpoint`` is ``Simulated(scenario=None)``, the
nonlinear machine in the loop's own thread, or ``Udp(address)``, a machine that speaks the packets of ``docs/reference/live.md``.

``LiveSession``, of which any thread may call anything; nothing waits for the loop but ``wait``:

``on()``, ``passive()``, ``off()``
    Ask the supervisor for the feel; for power without feel; for no power, the state at the start.
``stop()``, ``acknowledge()``
    The big button; clears what is latched. After that ``off()``, then ``on()`` start again.
``feel`` (get, set)
    Mapping of ``feel.`` rows as ``Loader.replace`` takes them; the law goes with it. What is set is added to what there is, and
    faded in without a bump over ``fade_s``; while one fades in, the newest waits.
``loader``, ``law``
    The loader with the feel as programmed now, and its law.
``trim_rad``, ``stiffness_factor``, ``shaker`` (get, set)
    The loop goes there at a bounded rate.
``hand_force_n``, ``hand_angle_rad`` (get, set)
    Of a simulated machine: a force at the grip; an angle that the hand holds, ``None`` to let go.
``inject_fault(fault, sensor=None, by=0)``, ``clear_faults()``
    Faults of a simulated machine, of ``FAULTS`` and ``SENSORS``.
``state``
    ``State(cycle, time_s, name, trips, missed, silent, lost_rows, recorded, unrecorded_rows, record_ended, ended)``;
    name is one of ``STATES``.
``host``
    ``HostState(listens, address, packets, refused, silent_s, share)``, or ``None``.
``trips``
    Tuple of ``Trip(name, sentence)``: what acted since it was acknowledged.
``columns``, ``history(since=-1, most=None)``
    Names of the columns, with SI units at the end; array (rows, columns), a row each cycle after cycle ``since``, the newest
    ``most`` of them. ``cycle`` is a column.
``timing``
    ``Timing(late, work, period_s)``: two ``Histogram(edges_us, counts)``, how late the thread woke, how long it worked.
``wait(cycles, timeout_s)``
    Until so many more cycles have gone by.
``realtime_status``
    What the system gave of priority, locked memory and a processor that stays awake, a sentence each.

``read_live_record(path)`` gives a record's table, ``replay(path)`` runs it again and compares every bit. ``Machine(loader)`` is the
simulated machine alone, for another process to serve.

Example:
    >>> import forcefeel as ff
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
