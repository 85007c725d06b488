"""MCAP logs of other programs: the clock in the messages, lists, topics that can be read."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.writer import Writer

from twin.errors import MeasuredError
from twin.measured.forces import read_forces
from twin.measured.read import read_log
from twin.measured.settings import LogReading

BEGIN = 1_700_000_000
N = 200
STEP = 1_000_000


def force(k: int) -> dict[str, float]:
    return {"x": 1200.0 + k, "y": -300.0 - k, "z": 80.0 + 0.5 * k}


def ros(k: int) -> dict[str, Any]:
    stamp = {"sec": BEGIN, "nanosec": k * STEP}
    return {
        "header": {"stamp": stamp, "frame_id": "tool"},
        "wrench": {"force": force(k), "torque": {"x": 0, "y": 0, "z": 0}},
    }


def foxglove(k: int) -> dict[str, Any]:
    return {"timestamp": {"sec": BEGIN, "nsec": k * STEP}, "force": list(force(k).values())}


def iso(k: int) -> dict[str, Any]:
    return {"stamp": f"2024-05-01T10:00:00.{k:03d}Z", **{f"F{a}": v for a, v in force(k).items()}}


def plain(k: int) -> dict[str, Any]:
    return {f"F{a}": v for a, v in force(k).items()}


def write(
    path: Path,
    make: Callable[[int], dict[str, Any] | bytes],
    *,
    log_ns: Callable[[int], int] = lambda k: BEGIN * 10**9 + k * STEP,
    sent_ns: Callable[[int], int] = lambda k: BEGIN * 10**9 + k * STEP,
    order: Iterator[int] | range = range(N),
    topic: str = "/wrench",
    others: dict[str, str] | None = None,
) -> Path:
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema(name="Any", encoding="jsonschema", data=b"{}")
        for name, encoding in (others or {}).items():
            writer.register_channel(topic=name, message_encoding=encoding, schema_id=schema)
        channel = writer.register_channel(topic=topic, message_encoding="json", schema_id=schema)
        for k in order:
            made = make(k)
            data = made if isinstance(made, bytes) else json.dumps(made).encode()
            writer.add_message(channel_id=channel, log_time=log_ns(k), publish_time=sent_ns(k), data=data)
        writer.finish()
    return path


def burst(k: int) -> int:
    return BEGIN * 10**9 + k // 50 * 50 * STEP


@pytest.mark.parametrize("make", [ros, foxglove, iso])
def test_bursts_with_stamps_in_the_messages(make: Callable[[int], dict[str, Any]], tmp_path: Path) -> None:
    log = read_forces(write(tmp_path / "a.mcap", make, log_ns=burst, sent_ns=burst))
    assert log.rate_hz == pytest.approx(1000.0)
    np.testing.assert_allclose(log.t_s, np.arange(N) / 1000.0, atol=1e-9)
    np.testing.assert_allclose(log.force_n, [list(force(k).values()) for k in range(N)])
    assert "time from the stamps in the messages" in log.notes


def test_messages_out_of_order_are_sorted_by_their_stamps(tmp_path: Path) -> None:
    order = [*range(50), 51, 50, *range(52, N)]
    log = read_forces(write(tmp_path / "a.mcap", ros, log_ns=burst, order=iter(order)))
    np.testing.assert_allclose(log.force_n[:, 0], 1200.0 + np.arange(N))
    assert "messages out of order were sorted by their time" in log.notes


def test_bursts_with_the_time_of_sending(tmp_path: Path) -> None:
    log = read_forces(write(tmp_path / "a.mcap", plain, log_ns=burst))
    assert log.rate_hz == pytest.approx(1000.0)
    assert any(n.startswith("time at which the messages were sent") for n in log.notes)


def test_bursts_with_no_other_clock_are_counted_at_the_true_rate(tmp_path: Path) -> None:
    log = read_forces(write(tmp_path / "a.mcap", plain, log_ns=burst, sent_ns=burst))
    assert log.rate_hz == pytest.approx(1000.0)
    assert any("occur twice: time counted at 1000 Hz" in n for n in log.notes)


def test_stamps_that_were_not_set_are_not_used(tmp_path: Path) -> None:
    log = read_forces(write(tmp_path / "a.mcap", lambda k: {**plain(k), "stamp": {"sec": 0, "nsec": 0}}))
    assert log.rate_hz == pytest.approx(1000.0)


def test_times_in_fields_win_over_the_recorder(tmp_path: Path) -> None:
    log = read_forces(
        write(tmp_path / "a.mcap", lambda k: {"timestamp": BEGIN * 10**9 + k * STEP, **plain(k)}, log_ns=burst)
    )
    assert log.rate_hz == pytest.approx(1000.0, rel=1e-3)


def test_lists_are_columns(tmp_path: Path) -> None:
    pairs = {f"f{a}": [v, v] for a, v in force(0).items()}
    path = write(tmp_path / "a.mcap", lambda k: pairs)
    with pytest.raises(MeasuredError, match=r'columns are fx\[1\], fx\[2\], .*--map "x=fx\[1\],y=fy\[1\],z=fz\[1\]"'):
        read_forces(path)
    log = read_forces(path, LogReading(map="x=fx[1],y=fy[2],z=fz[1]"))
    np.testing.assert_allclose(log.force_n[0], list(force(0).values()))


def test_long_lists_are_named(tmp_path: Path) -> None:
    path = write(tmp_path / "a.mcap", lambda k: {f"f{a}": [v] * 100 for a, v in force(k).items()})
    with pytest.raises(MeasuredError, match=r"no columns of numbers .* not read: fx \(list of 100 numbers\), fy"):
        read_forces(path)


@pytest.mark.parametrize(
    ("data", "why"),
    [
        (b'{"Fx": 1, Fy', "Expecting property name"),
        (b"[" * 100_000, "values nested too deep"),
        (b'{"Fx": 1' + b"0" * 400 + b"}", "int too large"),
        (b'{"Fx": \xff}', "invalid start byte"),
    ],
)
def test_a_message_that_cannot_be_read_is_named(data: bytes, why: str, tmp_path: Path) -> None:
    path = write(tmp_path / "a.mcap", lambda k: data if k == 100 else plain(k))
    with pytest.raises(MeasuredError, match=rf"a.mcap: message 101 on /wrench cannot be read as JSON: .*{why}"):
        read_forces(path)


def test_only_readable_topics_are_offered(tmp_path: Path) -> None:
    path = write(tmp_path / "a.mcap", plain, others={"/force_raw": "cdr"}, topic="/dyno")
    assert "topic /dyno" in read_log(path).format
    path = write(tmp_path / "a.mcap", plain, others={"/imu": "cdr", "/b": "protobuf"}, topic="/a")
    message = r"topics are /b \(protobuf\), /a \(json\) \(not readable: /imu \(cdr\)\); choose one by --group"
    with pytest.raises(MeasuredError, match=message):
        read_log(path)
    with pytest.raises(MeasuredError, match="no topic '/imu' in protobuf or JSON; expected one of /b, /a"):
        read_log(path, LogReading(group="/imu"))


def test_no_readable_topic(tmp_path: Path) -> None:
    with (tmp_path / "a.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema(name="geometry_msgs/msg/Wrench", encoding="ros2msg", data=b"")
        channel = writer.register_channel(topic="/wrench", message_encoding="cdr", schema_id=schema)
        for k in range(3):
            writer.add_message(channel_id=channel, log_time=k, publish_time=k, data=b"abcd")
        writer.finish()
    with pytest.raises(MeasuredError, match=r"no topic in protobuf or JSON, topics are /wrench \(cdr\); expected"):
        read_log(tmp_path / "a.mcap")


def test_stamps_and_lists_of_protobuf(tmp_path: Path) -> None:
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
    from google.protobuf.timestamp_pb2 import DESCRIPTOR as TIMESTAMP

    made = descriptor_pb2.FileDescriptorProto(name="w.proto", package="w", syntax="proto3", dependency=[TIMESTAMP.name])
    wrench = made.message_type.add(name="Wrench")
    kind = descriptor_pb2.FieldDescriptorProto
    wrench.field.add(
        name="stamp",
        number=1,
        type=kind.TYPE_MESSAGE,
        type_name=".google.protobuf.Timestamp",
        label=kind.LABEL_OPTIONAL,
    )
    wrench.field.add(name="force", number=2, type=kind.TYPE_DOUBLE, label=kind.LABEL_REPEATED)
    pool = descriptor_pool.DescriptorPool()
    own = descriptor_pb2.FileDescriptorProto()
    TIMESTAMP.CopyToProto(own)
    for part in (own, made):
        pool.Add(part)
    wanted = message_factory.GetMessageClass(pool.FindMessageTypeByName("w.Wrench"))
    both = descriptor_pb2.FileDescriptorSet(file=[own, made]).SerializeToString()
    with (tmp_path / "a.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema(name="w.Wrench", encoding="protobuf", data=both)
        channel = writer.register_channel(topic="/w", message_encoding="protobuf", schema_id=schema)
        for k in range(N):
            message = wanted(force=force(k).values())
            message.stamp.FromNanoseconds(BEGIN * 10**9 + k * STEP)
            data = message.SerializeToString()
            writer.add_message(channel_id=channel, log_time=burst(k), publish_time=burst(k), data=data)
        writer.finish()
    log = read_forces(tmp_path / "a.mcap")
    assert log.rate_hz == pytest.approx(1000.0)
    np.testing.assert_allclose(log.force_n, [list(force(k).values()) for k in range(N)])


@pytest.mark.parametrize("unit", [1.0, 1_000_000, 1000, 1])
def test_stamps_that_are_one_number(unit: float, tmp_path: Path) -> None:
    """Whole ms, us and ns since 1970, or seconds with decimals; messages recorded late."""

    def stamped(k: int) -> dict[str, Any]:
        at = float(BEGIN + k / 1000) if unit == 1.0 else (BEGIN * 10**9 + k * STEP) // int(unit)
        return {"header": {"stamp": at}, **plain(k)}

    log = read_forces(write(tmp_path / "a.mcap", stamped, log_ns=lambda k: BEGIN * 10**9 + (k // 10) * 10**7))
    assert log.rate_hz == pytest.approx(1000.0, rel=1e-6) and "time from the stamps in the messages" in log.notes


def test_a_whole_number_since_the_start_of_a_machine_is_not_a_moment(tmp_path: Path) -> None:
    log = read_forces(write(tmp_path / "a.mcap", lambda k: {"stamp": 5_000_000_000 + k * STEP, **plain(k)}))
    assert log.rate_hz == pytest.approx(1000.0) and "from the time column" in " ".join(log.notes)


def test_messages_recorded_in_bursts_without_times_of_their_own(tmp_path: Path) -> None:
    """Ten messages each 10 ms, a few microseconds apart."""

    def late(k: int) -> int:
        return BEGIN * 10**9 + (k // 10 + 1) * 10_000_000 + k % 10 * 3000

    log = read_forces(write(tmp_path / "a.mcap", plain, log_ns=late, sent_ns=late))
    assert log.rate_hz == pytest.approx(1000.0) and log.gaps == ()
    assert "recorded in bursts" in log.notes
    np.testing.assert_allclose(log.force_n[:, 0], 1200.0 + np.arange(N))
