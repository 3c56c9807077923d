"""Properties of this computer that a real-time loop needs."""

import os
import resource
from pathlib import Path

from forcefeel.bus.result import Finding

_RTPRIO = 80
"""Least real-time priority that a user may have."""


def check_host() -> tuple[Finding, ...]:
    """Check kernel, processors and limits of this computer.

    A loop runs without them too; its worst latency is then that of a desktop, some milliseconds.

    Example:
        >>> [finding.name for finding in ff.bus.check_host()][:2]
        ['real-time kernel', 'isolated processor']
    """
    return (_kernel(), _isolated(), _governor(), _memory(), _priority(), _latency(), _affinity())


def _kernel() -> Finding:
    version = os.uname().version
    # /sys/kernel/realtime is also there on kernels that are not.
    ok = "PREEMPT_RT" in version
    return Finding(
        "real-time kernel", ok, version, "" if ok else "install a PREEMPT_RT kernel, such as linux-image-rt-amd64"
    )


def _isolated() -> Finding:
    isolated = _read("/sys/devices/system/cpu/isolated")
    remedy = "add isolcpus=1 nohz_full=1 to the kernel's command line, and restart"
    return Finding("isolated processor", bool(isolated), isolated or "none", "" if isolated else remedy)


def _governor() -> Finding:
    governors = {_read(str(path)) for path in Path("/sys/devices/system/cpu").glob("cpu*/cpufreq/scaling_governor")}
    ok = governors <= {"performance"}
    stated = ", ".join(sorted(governors)) or "no frequency scaling"
    return Finding("frequency governor", ok, stated, "" if ok else "sudo cpupower frequency-set -g performance")


def _memory() -> Finding:
    soft, _ = resource.getrlimit(resource.RLIMIT_MEMLOCK)
    ok = soft == resource.RLIM_INFINITY or os.geteuid() == 0
    stated = "unlimited" if soft == resource.RLIM_INFINITY else f"{soft // 1024:,} KiB"
    remedy = "echo '@realtime - memlock unlimited' | sudo tee -a /etc/security/limits.d/realtime.conf"
    return Finding("memory lock", ok, stated, "" if ok else remedy)


def _priority() -> Finding:
    soft, _ = resource.getrlimit(resource.RLIMIT_RTPRIO)
    ok = soft >= _RTPRIO or soft == resource.RLIM_INFINITY or os.geteuid() == 0
    remedy = f"echo '@realtime - rtprio {_RTPRIO}' | sudo tee -a /etc/security/limits.d/realtime.conf; add the user to this group"
    stated = "root" if os.geteuid() == 0 else f"priority {soft}"
    return Finding("real-time priority", ok, stated, "" if ok else remedy)


def _latency() -> Finding:
    ok = os.access("/dev/cpu_dma_latency", os.W_OK)
    remedy = "sudo chgrp realtime /dev/cpu_dma_latency; sudo chmod g+w /dev/cpu_dma_latency"
    return Finding("processor stays awake", ok, "allowed" if ok else "not allowed", "" if ok else remedy)


def _affinity() -> Finding:
    allowed, there = len(os.sched_getaffinity(0)), os.cpu_count() or 1
    ok = there > 1
    remedy = "use a computer with two processors or more: one for the loop"
    return Finding("processors", ok, f"{allowed} of {there} allowed", "" if ok else remedy)


def _read(path: str) -> str:
    """Text of a file of the system; empty if it has none."""
    try:
        return Path(path).read_text(encoding="utf-8").strip()
    except OSError:
        return ""
