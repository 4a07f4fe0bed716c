"""Readers of logs: the distance between the samples, and a sentence for every log that does not show it."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.logs.written import FIELDS, ODOMETRY, POSE, TEXT, Origin, Row, mcap, ulog
from worker.engine.systems.simulators.logs.approach import Column, Sphere, Track, Unreadable, closest
from worker.engine.systems.simulators.logs.rosbag import separation_of_mcap
from worker.engine.systems.simulators.logs.ulog import TOPIC, separation_of_ulog

STRAIGHT = [(0.1 * k, 2.0 * k, 0.0, -5.0) for k in range(11)]
"""North at 20 m/s and 5 m up, a sample each 2 m."""
BESIDE = Sphere(7.0, 3.0, -5.0)
"""Between two samples: both are farther than 3 m."""


def test_the_minimum_is_between_samples(tmp_path: Path) -> None:
    found = separation_of_ulog(ulog(tmp_path / "a.ulg", {TOPIC: STRAIGHT}), [BESIDE])
    assert found.d_min == pytest.approx(3.0, abs=1e-6)
    assert found.time == pytest.approx(0.35, abs=1e-6)
    assert min(math.hypot(7.0 - x, 3.0) for _, x, _, _ in STRAIGHT) > 3.1


def test_obstacles_have_surfaces_and_the_closest_one_counts(tmp_path: Path) -> None:
    file = ulog(tmp_path / "a.ulg", {TOPIC: STRAIGHT})
    obstacles = [Sphere(7.0, 30.0, 0.0), Column(11.0, -4.0, 1.5), Sphere(7.0, 3.0, 95.0, 90.0)]
    found = separation_of_ulog(file, obstacles)
    assert found.d_min == pytest.approx(2.5, abs=1e-6)
    assert found.to == str(obstacles[1])
    assert separation_of_ulog(file, [Sphere(7.0, 0.0, -5.0, 2.0)]).d_min == pytest.approx(-2.0, abs=1e-6)


def test_two_tracks_with_other_times(tmp_path: Path) -> None:
    """Head on, 3 m apart: the relative position is exact between the samples of both."""
    meeting = [(0.07 * k, 20.0 - 1.4 * k, 3.0, -5.0) for k in range(16)]
    file = ulog(tmp_path / "a.ulg", {TOPIC: STRAIGHT, "intruder": meeting})
    found = separation_of_ulog(file, other="intruder")
    assert (found.d_min, found.to) == (pytest.approx(3.0, abs=1e-5), "intruder")
    assert found.time == pytest.approx(0.5, abs=1e-5)


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        ([], "the log has no topic vehicle_local_position"),
        (STRAIGHT[:1], "has 1 samples; at least 2 are required"),
        (STRAIGHT[:4] + STRAIGHT[9:], "has no sample for 0.600 s after t = 0.300 s; at most 0.5 s are allowed"),
        ([*STRAIGHT[:5], (0.5, math.nan, 0, 0)], "has no finite position at t = 0.500 s"),
        ([*STRAIGHT[:5], (0.5, 10, 0, -5, 0, 1, 0, 0)], "has no valid position at t = 0.500 s (xy_valid is 0)"),
        ([*STRAIGHT[:5], (0.5, 10, 0, -5, 1, 1, 1, 0)], "was reset at t = 0.500 s (xy_reset_counter)"),
        ([*STRAIGHT[:5], STRAIGHT[3]], "does not increase after t = 0.400 s"),
        ([*STRAIGHT[:5], STRAIGHT[4]], "does not increase after t = 0.400 s"),
    ],
)
def test_a_log_that_does_not_show_the_vehicle_gives_no_distance(tmp_path: Path, rows: Any, expected: str) -> None:
    with pytest.raises(Unreadable) as caught:
        separation_of_ulog(ulog(tmp_path / "a.ulg", {TOPIC: rows}), [BESIDE])
    assert expected in str(caught.value)


HERE = (1, 47.0, 8.0, 500.0)
UNKNOWN = (0, math.nan, math.nan, math.nan)
ELSEWHERE = {"ref_timestamp": (2, *HERE[1:]), "ref_lat": (1, 47.001, 8.0, 500.0), "ref_lon": (1, 47.0, 8.001, 500.0)}
ELSEWHERE |= {"ref_alt": (1, 47.0, 8.0, 510.0)}


@pytest.mark.parametrize("origin", [HERE, UNKNOWN])
def test_an_origin_that_stays_is_no_obstacle_to_a_distance(tmp_path: Path, origin: Origin) -> None:
    origins = dict.fromkeys((TOPIC, "intruder"), [origin] * 11)
    aside = [(t, x, y + 3.0, z) for t, x, y, z in STRAIGHT]
    for known in (origins, {TOPIC: origins[TOPIC]}, {}):
        file = ulog(tmp_path / "a.ulg", {TOPIC: STRAIGHT, "intruder": aside}, origins=known)
        assert separation_of_ulog(file, other="intruder").d_min == pytest.approx(3.0)


@pytest.mark.parametrize("field", ELSEWHERE)
def test_an_origin_that_moves_gives_no_distance(tmp_path: Path, field: str) -> None:
    for origins in ([HERE] * 5 + [ELSEWHERE[field]] * 6, [UNKNOWN] * 5 + [HERE] * 6):
        file = ulog(tmp_path / "a.ulg", {TOPIC: STRAIGHT, "intruder": STRAIGHT}, origins={TOPIC: origins})
        for asked in ((TOPIC, None), ("intruder", TOPIC)):
            with pytest.raises(Unreadable, match=rf"the origin of {TOPIC} changed at t = 0\.500 s"):
                separation_of_ulog(file, [BESIDE], topic=asked[0], other=asked[1])


@pytest.mark.parametrize("field", ["ref_lat", "ref_lon", "ref_alt"])
def test_two_topics_with_different_origins_have_no_distance(tmp_path: Path, field: str) -> None:
    for one, two in ((HERE, ELSEWHERE[field]), (UNKNOWN, HERE)):
        origins = {TOPIC: [one] * 11, "intruder": [two] * 11}
        file = ulog(tmp_path / "a.ulg", {TOPIC: STRAIGHT, "intruder": STRAIGHT}, origins=origins)
        with pytest.raises(Unreadable, match=r"has the origin ref_.*, intruder has"):
            separation_of_ulog(file, other="intruder")


def test_the_origins_of_two_topics_may_be_set_at_different_times(tmp_path: Path) -> None:
    origins = {TOPIC: [HERE] * 11, "intruder": [ELSEWHERE["ref_timestamp"]] * 11}
    aside = [(t, x, y + 3.0, z) for t, x, y, z in STRAIGHT]
    file = ulog(tmp_path / "a.ulg", {TOPIC: STRAIGHT, "intruder": aside}, origins=origins)
    assert separation_of_ulog(file, other="intruder").d_min == pytest.approx(3.0)


def test_a_ulog_that_is_cut_within_a_message_is_refused(tmp_path: Path) -> None:
    whole = ulog(tmp_path / "a.ulg", {TOPIC: STRAIGHT}).read_bytes()
    for length in sorted(set(range(len(whole))) - message_ends(whole)):
        (tmp_path / "cut.ulg").write_bytes(whole[:length])
        with pytest.raises(Unreadable):
            separation_of_ulog(tmp_path / "cut.ulg", [BESIDE])


def test_a_log_that_ends_between_two_messages_is_a_shorter_one(tmp_path: Path) -> None:
    file = ulog(tmp_path / "a.ulg", {TOPIC: STRAIGHT[:3]})
    assert separation_of_ulog(file, [BESIDE]).d_min > 4.0
    with pytest.raises(Unreadable, match=r"ends after 0\.200 s; at least 1 s are expected \(lasts\)"):
        separation_of_ulog(file, [BESIDE], lasts=1.0)


def message_ends(content: bytes) -> set[int]:
    ends, at = set(), 16
    while at < len(content):
        at += 3 + int.from_bytes(content[at : at + 2], "little")
        ends.add(at)
    return ends


def test_other_topics_and_fields(tmp_path: Path) -> None:
    file = ulog(tmp_path / "a.ulg", {TOPIC: STRAIGHT})
    with pytest.raises(Unreadable, match="the log has no topic intruder:1"):
        separation_of_ulog(file, other="intruder:1")
    late = ulog(tmp_path / "b.ulg", {TOPIC: STRAIGHT, "intruder": [(t + 0.8, x, y, z) for t, x, y, z in STRAIGHT]})
    with pytest.raises(
        Unreadable, match=r"intruder has no sample for 0\.800 s after t = 0\.000 s, while vehicle_local"
    ):
        separation_of_ulog(late, other="intruder")
    odd = ulog(tmp_path / "c.ulg", {TOPIC: STRAIGHT}, FIELDS.replace("float z", "float down"))
    with pytest.raises(Unreadable, match="the topic vehicle_local_position has no z"):
        separation_of_ulog(odd, [BESIDE])
    for content in (b"", b"ULog", b"\0" * 100):
        odd.write_bytes(content)
        with pytest.raises(Unreadable, match=r"c\.ulg is not a ULog file"):
            separation_of_ulog(odd, [BESIDE])
    with pytest.raises(Unreadable, match=r"none\.ulg cannot be read: No such file"):
        separation_of_ulog(tmp_path / "none.ulg", [BESIDE])


def test_a_ulog_whose_format_has_lost_its_time_is_named(tmp_path: Path) -> None:
    """One byte of its description was damaged, which ended in a KeyError."""
    file = ulog(tmp_path / "log.ulg", {TOPIC: STRAIGHT}, FIELDS.replace("uint64_t timestamp", "uint64_t timestomp"))
    with pytest.raises(Unreadable, match="the topic vehicle_local_position has no timestamp"):
        separation_of_ulog(file, [BESIDE])


def recorded(tmp_path: Path, **changed: Any) -> Path:
    meeting = [(0.07 * k, 20.0 - 1.4 * k, 3.0, -5.0) for k in range(16)]
    topics: Any = {"/odom": (ODOMETRY, "map", STRAIGHT), "/person": (POSE, "map", meeting)}
    return mcap(tmp_path / "a.mcap", topics | changed)


def test_two_poses_of_a_recording(tmp_path: Path) -> None:
    file = recorded(tmp_path)
    assert separation_of_mcap(file, "/odom", "/person").d_min == pytest.approx(3.0, abs=1e-9)
    assert separation_of_mcap(tmp_path, "/odom", obstacles=[BESIDE]).d_min == pytest.approx(3.0, abs=1e-9)


def test_a_split_recording_is_one_track(tmp_path: Path) -> None:
    for name, rows in (("bag_10", STRAIGHT[5:]), ("bag_2", STRAIGHT[:5])):
        mcap(tmp_path / f"{name}.mcap", {"/odom": (ODOMETRY, "map", rows)})
    assert separation_of_mcap(tmp_path, "/odom", obstacles=[BESIDE]).d_min == pytest.approx(3.0, abs=1e-9)


def with_metadata(folder: Path, text: str) -> Path:
    for name, rows in (("bag_0", STRAIGHT[:5]), ("bag_1", STRAIGHT[5:])):
        mcap(folder / f"{name}.mcap", {"/odom": (ODOMETRY, "map", rows)})
    (folder / "metadata.yaml").write_text(text)
    return folder


def naming(*names: str) -> str:
    lines = "".join(f"    - {name}\n" for name in names)
    known = f"  version: 9\n  storage_identifier: mcap\n  relative_file_paths:\n{lines}"
    return f"rosbag2_bagfile_information:\n{known}  duration:\n    nanoseconds: 1000000000\n  custom_data: ~\n"


def test_a_recording_with_all_files_that_its_metadata_names(tmp_path: Path) -> None:
    folder = with_metadata(tmp_path, naming("bag_0.mcap", "bag_1.mcap"))
    assert separation_of_mcap(folder, "/odom", obstacles=[BESIDE]).d_min == pytest.approx(3.0, abs=1e-9)


@pytest.mark.parametrize(
    ("metadata", "expected"),
    [
        (naming("bag_0.mcap", "bag_1.mcap", "bag_2.mcap"), "metadata.yaml names bag_2.mcap, which is not in "),
        (naming("bag_0.mcap", "bag_1.mcap.zstd"), "metadata.yaml names bag_1.mcap.zstd, which is not in "),
        (naming("bag_0.mcap"), "holds bag_1.mcap, which metadata.yaml does not name; one recording is expected"),
        (naming(), "does not state the files of the recording: relative_file_paths names no file"),
        ("a: 1\n", "does not state the files of the recording: it has no relative_file_paths"),
        ("", "does not state the files of the recording: it has no relative_file_paths"),
        (naming("bag_0.mcap") + naming("bag_0.mcap", "bag_1.mcap"), "is given twice"),
    ],
)
def test_a_recording_that_is_not_the_one_of_its_metadata_gives_no_distance(
    tmp_path: Path, metadata: str, expected: str
) -> None:
    with pytest.raises(Unreadable) as caught:
        separation_of_mcap(with_metadata(tmp_path, metadata), "/odom", obstacles=[BESIDE])
    assert expected in str(caught.value)


@pytest.mark.parametrize(
    ("person", "expected"),
    [
        ((POSE, "odom", STRAIGHT), "/odom is in the frame 'map', /person in 'odom'; one frame is expected"),
        ((POSE, "map", []), "the recording has no message on /person"),
        ((TEXT, "map", STRAIGHT), "/person has messages of std_msgs/msg/String; "),
        ((POSE, "map", STRAIGHT + STRAIGHT), "the time of /person does not increase after t = 1.000 s"),
        ((POSE, "map", STRAIGHT[:3]), "/person has no sample for 0.800 s after t = 0.200 s, while /odom has"),
    ],
)
def test_a_recording_that_does_not_show_both_gives_no_distance(tmp_path: Path, person: Any, expected: str) -> None:
    with pytest.raises(Unreadable) as caught:
        separation_of_mcap(recorded(tmp_path, **{"/person": person}), "/odom", "/person")
    assert expected in str(caught.value)


def test_a_cut_recording_is_refused(tmp_path: Path) -> None:
    whole = recorded(tmp_path).read_bytes()
    for length in range(0, len(whole), 7):
        (tmp_path / "a.mcap").write_bytes(whole[:length])
        with pytest.raises(Unreadable):
            separation_of_mcap(tmp_path / "a.mcap", "/odom", "/person")


def test_damage_inside_is_refused(tmp_path: Path) -> None:
    whole = bytearray(recorded(tmp_path).read_bytes())
    whole[len(whole) // 4] ^= 0xFF
    (tmp_path / "a.mcap").write_bytes(whole)
    with pytest.raises(Unreadable, match=r"a\.mcap cannot be read to its end"):
        separation_of_mcap(tmp_path / "a.mcap", "/odom", "/person")


@pytest.mark.parametrize("package", ["pyulog", "mcap.reader"])
def test_without_its_package_a_sentence_names_what_to_install(
    tmp_path: Path, package: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    bag, log = recorded(tmp_path), ulog(tmp_path / "a.ulg", {TOPIC: STRAIGHT})
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(Unreadable, match=r"pip install 'clearance\[logs\]'"):
        separation_of_ulog(log, [BESIDE]) if package == "pyulog" else separation_of_mcap(bag, "/odom", "/person")


def test_an_invalid_request_is_refused() -> None:
    rows: list[Row] = STRAIGHT
    table = np.array(rows)
    track = Track("t", table[:, 0], table[:, 1:])
    with pytest.raises(ValueError, match="nothing to measure"):
        closest(track, [], None, 0.5)
    with pytest.raises(ValueError, match="gap: 0"):
        closest(track, [BESIDE], None, 0)
    with pytest.raises(ValueError, match="finite coordinates"):
        closest(track, [Sphere(0, 0, math.nan)], None, 0.5)
    with pytest.raises(ValueError, match="radius of at least 0"):
        closest(track, [Sphere(0, 0, 0, -1.0)], None, 0.5)


def test_random_tracks_agree_with_dense_sampling() -> None:
    chance = np.random.default_rng(3)
    for _ in range(20):
        tracks = []
        for name in "ab":
            times = np.concatenate([[0.0], np.sort(chance.uniform(0.01, 0.99, 15)), [1.0]])
            tracks.append(Track(name, times, chance.normal(size=(17, 3))))
        found = closest(tracks[0], [], tracks[1], 1.0)
        dense = np.linspace(0, 1, 20001)
        a, b = (np.stack([np.interp(dense, t.times, axis) for axis in t.positions.T], 1) for t in tracks)
        distances = np.linalg.norm(a - b, axis=1)
        assert found.d_min <= distances.min() + 1e-12
        assert found.d_min == pytest.approx(distances.min(), abs=5e-3)
