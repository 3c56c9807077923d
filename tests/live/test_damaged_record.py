"""Damaged records: each is refused with one sentence, without a panic and without memory for what a damaged length promises."""

import resource
import struct

import numpy as np
import pytest

import forcefeel as ff

HUGE = (2**64 - 1, 2**63, 2**40, 2**32)
CHUNK, DATA_END = 6, 15
HEAD = 9
"""Bytes of a record's code and length."""
MOST_GROWTH_KB = 64 * 1024
"""Growth of memory over thousands of reads of a file of a tenth of a megabyte; a length that is believed takes gigabytes."""


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    path = tmp_path_factory.mktemp("whole") / "run.mcap"
    record_cycles(path, 300)
    return path.read_bytes()


def record_cycles(path, cycles):
    loader = ff.digital_elevator()
    scenario = ff.Scenario(ff.Step(50.0), duration_s=cycles * loader["controller.period"], sample_s=5e-4)
    endpoint = ff.live.Simulated(scenario)
    with ff.live.start(loader, endpoint=endpoint, real_time=False, supervised=False, record=path) as running:
        running.wait(10**6)


def records(data, begin, end):
    """Places, codes and lengths of the records, those in chunks among them."""
    at = begin
    while at < end:
        code, length = struct.unpack_from("<BQ", data, at)
        yield at, code, length
        if code == CHUNK:
            (packing,) = struct.unpack_from("<I", data, at + HEAD + 28)
            yield from records(data, at + HEAD + 40 + packing, at + HEAD + length)
        at += HEAD + length


def truncated(data):
    return [data[: len(data) * k // 97] for k in range(97)]


def flipped(data):
    """A bit of every 241st byte, and every one of the first and last records."""
    places = sorted({*range(0, len(data), 241), *range(300), *range(len(data) - 300, len(data))})
    return [data[:at] + bytes([data[at] ^ (1 << at % 8)]) + data[at + 1 :] for at in places]


def with_huge_lengths(data, *, summed):
    """Each length of a record, and each word of four bytes in the first ones; where chunks have no check sum, too."""
    data = bytearray(data)
    heads = list(records(data, 8, len(data) - 8))
    if not summed:
        for at, code, _ in heads:
            if code == CHUNK:
                data[at + HEAD + 24 : at + HEAD + 28] = bytes(4)
            if code == DATA_END:
                data[at + HEAD : at + HEAD + 4] = bytes(4)
    places = [at + 1 for at, _, _ in heads[:: max(len(heads) // 60, 1)]]
    changed = [data[:at] + struct.pack("<Q", huge) + data[at + 8 :] for at in places for huge in HUGE]
    words = range(8, 600, 3)
    changed += [data[:at] + b"\xff\xff\xff\xff" + data[at + 4 :] for at in words]
    return [bytes(one) for one in changed]


MUTANTS = {
    "truncated": truncated,
    "flipped": flipped,
    "huge": lambda data: with_huge_lengths(data, summed=True),
}


@pytest.mark.parametrize("kind", MUTANTS)
def test_damaged_record_raises_input_error(tmp_path, whole, kind):
    path = tmp_path / "run.mcap"
    path.write_bytes(whole)
    ff.qualification.read_record(path)
    mutants = MUTANTS[kind](whole)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert len(mutants) > 90
    for mutant in mutants:
        path.write_bytes(mutant)
        with pytest.raises(ff.InputError, match=r"run\.mcap: ") as refused:
            ff.qualification.read_record(path)
        assert "\n" not in str(refused.value)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < MOST_GROWTH_KB


def test_damage_without_checksum_is_read_up_to_it_or_refused(tmp_path, whole):
    """As another program may write chunks: then every length is the first thing that is wrong."""
    path = tmp_path / "run.mcap"
    path.write_bytes(whole)
    rows = ff.live.read_live_record(path).rows
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for mutant in with_huge_lengths(whole, summed=False):
        path.write_bytes(mutant)
        try:
            found = ff.live.read_live_record(path)
            ff.live.replay(path)
        except ff.InputError:
            continue
        if found.columns == ff.live.COLUMNS:
            assert len(found.rows) <= len(rows)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < MOST_GROWTH_KB


def test_chunk_length_that_panicked_the_library_is_refused(tmp_path, whole, forcefeel):
    heads = list(records(whole, 8, len(whole) - 8))
    at = heads[len(heads) // 2][0] + 1
    (tmp_path / "run.mcap").write_bytes(whole[:at] + struct.pack("<Q", 2**64 - 1) + whole[at + 8 :])
    (tmp_path / "head.mcap").write_bytes(whole[: heads[1][0] + 1] + struct.pack("<Q", 2**64 - 1) + bytes(100))
    for command, *words in (
        ("qualify", "elevator-2khz", "--record", "static=run.mcap"),
        ("qualify", "elevator-2khz", "--record", "static=head.mcap"),
        ("identify", "elevator-2khz", "--fit", "k", "--data", "run.mcap"),
        ("simulate", "elevator-2khz", "--record", "run.mcap"),
    ):
        status, out, err = forcefeel(command, *words)
        assert (status, out) == (2, "")
        assert err.startswith("forcefeel: ")
        assert "mcap: " in err
    with pytest.raises(ff.InputError, match=r"a record of 18446744073709551615 bytes"):
        ff.live.read_live_record(tmp_path / "head.mcap")


def test_damaged_record_is_read_up_to_damage_on_request(tmp_path):
    path = tmp_path / "run.mcap"
    # Of several flushes the last chunk is damaged.
    with ff.live.start(ff.digital_elevator(), supervised=False, record=path) as running:
        running.wait(1500)
    data = bytearray(path.read_bytes())
    chunks = [at for at, code, _ in records(data, 8, len(data) - 8) if code == CHUNK]
    data[chunks[-1] + 60] ^= 1  # behind its head
    path.write_bytes(data)
    part = ff.live.read_live_record(path)
    damage = (
        f"chunk {len(chunks)} is damaged: a check sum does not fit what it is of (byte {chunks[-1]} of {len(data)})"
    )
    assert part.broken == damage
    with pytest.raises(ff.InputError, match=r"breaks off: .*it is whole up to [\d.]+ s") as refused:
        ff.qualification.read_record(path)
    assert "between_s" in str(refused.value)
    end = float(part.column("cycle")[-1]) * ff.digital_elevator()["controller.period"]
    read = ff.qualification.read_record(path, between_s=(0.0, end))
    assert np.array_equal(read.position, part.column("column_angle_rad"))
