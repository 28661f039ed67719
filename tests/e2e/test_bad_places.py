"""Bad places, bad wishes and bad moments: the command ends in a stack or in one line, never in between."""

from __future__ import annotations

import fcntl
import json
import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tests.e2e.guarded import BYTES, Outcome, run_all
from tests.e2e.test_command import COMMAND, contents, stepfield

from stepfield.errors import ScanError, StepfieldError
from stepfield.files import Digest
from stepfield.grid import Grid
from stepfield.scan import read_scan
from stepfield.stack import Stack
from stepfield.stack.check import check_stack
from stepfield.stack.folder import STALE

#: A build of many small compartments of noise: hundreds of kilobytes of images.
FINE = ("--cell", "0.002", "--tolerance", "0.01")


@pytest.fixture(scope="module")
def scan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """20 000 points of noise, 4 x 4 x 1 m."""
    path = tmp_path_factory.mktemp("scan") / "noise.npy"
    np.save(path, np.random.default_rng(0).random((20_000, 3)) * [4, 4, 1])
    return path


def whole(folder: Path) -> bool:
    return not check_stack(folder).faults


def ends_well(outcome: Outcome) -> Outcome:
    """Check what holds for every run: in time, in bounds, no crash, no traceback."""
    assert outcome.code >= 0, f"killed by signal {-outcome.code}: {outcome.stderr}"
    assert outcome.peak < BYTES
    assert "Traceback" not in outcome.stderr, outcome.stderr
    return outcome


# --------------------------------------------------------------------------------------- impossible wishes

#: Arguments, exit code, words of the sentence.
WISHES: dict[str, tuple[int, str]] = {
    "--cell=0": (2, "cell_size"),
    "--cell=-inf": (2, "cell_size"),
    "--cell=inf": (2, "cell_size"),
    "--cell=1e999": (2, "cell_size"),
    "--cell=": (2, "cell_size"),
    "--cell=1e-320": (1, "use at least"),
    "--cell=1e-6": (1, "use at least"),
    "--tolerance=nan": (2, "layer_tolerance"),
    "--tolerance=-1": (2, "layer_tolerance"),
    "--alpha=inf": (2, "alpha"),
    "--alpha=0": (2, "alpha"),
    "--alpha=1e308": (2, "alpha"),
    "--tolerance=1e308": (2, "layer_tolerance"),
    "--link-step=1e308": (2, "link_step"),
    "--link-step=-1": (2, "link_step"),
    "--min-points=0": (2, "min_points"),
    "--min-points=99999999999999999999": (2, "min_points"),
    "--max-layers=0": (2, "max_layers"),
    "--max-layers=1e400": (2, "max_layers"),
    "--bits=99999999999999999999999": (2, "bits"),
    "--crop=nan,0,0,1,1,1": (2, "crop"),
    "--crop=1,1,1,0,0,0": (2, "crop"),
    "--crop=9,9,9,10,10,10": (1, "crop box leaves no points"),
    "--crop=": (2, "crop"),
    "--classes=256": (2, "classes"),
    "--classes=-1": (2, "classes"),
    "--classes=": (2, "classes"),
    "--unit=furlong": (2, "unit"),
}
#: Odd wishes that can be granted.
GRANTED = {
    "--cell=1e9": "",
    "--tolerance=1e-300": "",
    "--alpha=1e-300": "",
    "--max-layers=1000000": "",
    "--crop=-1e308,-1e308,-1e308,1e308,1e308,1e308": "",
    "--classes=2": "has no classification",
}


@pytest.fixture(scope="module")
def wished(scan: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Outcome], Path]:
    """Run every wish, and return where they would write."""
    folder = tmp_path_factory.mktemp("wished")
    jobs = {
        wish: ["build", str(scan), "-o", str(folder / f"{number}"), wish]
        for number, wish in enumerate((*WISHES, *GRANTED))
    }
    return run_all(jobs), folder


@pytest.mark.parametrize("wish", WISHES)
def test_an_impossible_wish_is_refused_in_one_line(
    wished: tuple[dict[str, Outcome], Path], wish: str
) -> None:
    """Wrong usage and impossible jobs would else end in a traceback, an endless loop or a nonsense stack."""
    outcome, (code, words) = ends_well(wished[0][wish]), WISHES[wish]
    assert (outcome.code, outcome.stdout) == (code, ""), outcome.stderr
    assert re.fullmatch(r"error: .+\n", outcome.stderr)
    assert words in outcome.stderr
    assert not (wished[1] / str(list(WISHES).index(wish))).exists()


@pytest.mark.parametrize("wish", GRANTED)
def test_an_odd_wish_is_granted(wished: tuple[dict[str, Outcome], Path], wish: str) -> None:
    """Huge and tiny numbers that have a meaning must not overflow on the way to a whole stack."""
    outcome = ends_well(wished[0][wish])
    assert outcome.code == 0, outcome.stderr
    assert GRANTED[wish] in outcome.stderr
    assert whole(wished[1] / str(len(WISHES) + list(GRANTED).index(wish)))


def _advised(sentence: str) -> float:
    found = re.search(r"use at least (\S+) m", sentence)
    assert found, sentence
    return float(found[1])


def test_the_advised_cell_size_works(tmp_path: Path) -> None:
    """A strip of a kilometre: an advice that is refused in its turn would lead nowhere."""
    path = tmp_path / "strip.npy"
    np.save(path, np.random.default_rng(0).random((5000, 3)) * [1000, 2, 1])
    build = ["build", str(path), "-o", str(tmp_path / "out"), "--cell"]
    refused = run_all({"tiny": [*build, "1e-6"]}, 1)["tiny"]
    cell = _advised(ends_well(refused).stderr)
    done = ends_well(run_all({"advised": [*build, str(cell)]}, 1)["advised"])
    assert done.code == 0, done.stderr
    assert whole(tmp_path / "out")


@pytest.mark.parametrize("sides", [(1000.0, 1000.0), (1000.0, 0.0), (3.3, 7.7), (1e5, 1e5), (1e-3, 1e-3)])
def test_the_advised_cell_size_makes_a_grid(sides: tuple[float, float]) -> None:
    """Rounding the advice down would make it wrong for some sizes."""
    with pytest.raises(StepfieldError) as refused:
        Grid.over(0, 0, *sides, 1e-9)
    Grid.over(0, 0, *sides, _advised(str(refused.value)))


# -------------------------------------------------------------------------------------- scans that are none


@pytest.fixture(scope="module")
def strange(scan: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Outcome]:
    """Give the command everything that is not a scan, each as a scan."""
    place = tmp_path_factory.mktemp("strange")
    os.mkfifo(place / "pipe.ply")
    (place / "zero.ply").symlink_to("/dev/zero")
    (place / "loop.ply").symlink_to("loop.ply")
    (place / "dangling.ply").symlink_to("nowhere.ply")
    (place / "folder.ply").mkdir()
    (place / "empty.ply").touch()
    names = ["a" * 300 + ".ply", *(path.name for path in place.iterdir())]
    jobs = {name: ["build", str(place / name), "-o", str(place / "out")] for name in names}
    jobs |= {"": ["build", "", "-o", str(place / "out")], "info": ["info", ""], "check": ["check", ""]}
    jobs["project"] = ["build", "--project", "", "-o", str(place / "out")]
    jobs["second"] = ["build", str(scan), str(place / "zero.ply"), "-o", str(place / "out")]
    outcomes = run_all(jobs)
    assert not (place / "out").exists()
    return outcomes


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("pipe.ply", "is a device or a pipe"),
        ("zero.ply", "is a device or a pipe"),
        ("second", "is a device or a pipe"),
        ("loop.ply", "no such file"),
        ("dangling.ply", "no such file"),
        ("folder.ply", "is a folder, not a scan"),
        ("empty.ply", "is no PLY file"),
        ("a" * 300 + ".ply", "file name too long"),
        ("", "is a folder, not a scan"),
        ("info", "is a folder, not a scan"),
        ("check", "manifest"),
        ("project", "is a directory"),
    ],
    ids=lambda value: str(value)[:20],
)
def test_what_is_no_scan_is_refused_and_never_waited_for(
    strange: dict[str, Outcome], name: str, words: str
) -> None:
    """Opening a pipe waits for its writer, and a device never ends: both would hang a night's work."""
    outcome = ends_well(strange[name])
    assert (outcome.code, outcome.stdout) == (1, "")
    assert re.fullmatch(r"error: .+\n", outcome.stderr), outcome.stderr
    assert words in outcome.stderr


@pytest.mark.parametrize("left", [0, 50, 1000])
@pytest.mark.parametrize("kind", ["npy", "ply", "pcd", "las", "laz", "e57", "xyz"])
def test_a_scan_cut_short_between_looking_and_reading_is_one_sentence(
    scan: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str, left: int
) -> None:
    """Another program may still be writing the file: the size noted a moment ago is no longer true."""
    path = _as_kind(scan, tmp_path, kind)

    def cutting(path: Path) -> Digest:
        os.truncate(path, left)
        return Digest(path)

    monkeypatch.setattr("stepfield.scan.Digest", cutting)
    if left < 1000 - 950 * (kind == "xyz") or kind in ("laz", "e57"):  # within the header, or the only chunk
        with pytest.raises(ScanError, match=re.escape(path.name)) as refused:
            read_scan([path])
        assert "\n" not in str(refused.value)
    else:
        assert len(read_scan([path])) > 0


def test_a_scan_deleted_between_looking_and_reading_is_one_sentence(
    scan: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A file on a stick may vanish at any moment."""
    path = Path(shutil.copy(scan, tmp_path / "gone.npy"))
    monkeypatch.setattr("stepfield.scan.Digest", os.unlink)
    with pytest.raises(ScanError, match=r"gone\.npy: cannot be read \(no such file"):
        read_scan([path])


def _as_kind(scan: Path, folder: Path, kind: str) -> Path:
    """Write the scan's points in another format."""
    from stepfield.scan.write import write

    path = folder / f"scan.{kind}"
    if kind == "npy":
        return Path(shutil.copy(scan, path))
    if kind in ("pcd", "xyz"):
        head = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 20000\nHEIGHT 1\nDATA ascii\n" * (kind == "pcd")
        np.savetxt(path, np.load(scan), "%.3f", header=head.rstrip(), comments="")
        return path
    write(path, np.load(scan), {})
    return path


def test_one_scan_twice_and_three_hundred_scans_are_added_up(scan: Path, tmp_path: Path) -> None:
    """A survey comes in hundreds of tiles; they must not run out of open files or threads."""
    tiles = []
    for number in range(300):
        tiles.append(tmp_path / f"{number}.npy")
        np.save(tiles[-1], np.load(scan)[number * 60 : number * 60 + 60])
    done = run_all(
        {
            "twice": ["build", str(scan), str(scan), "-o", str(tmp_path / "twice")],
            "many": ["build", *map(str, tiles), "-o", str(tmp_path / "many")],
        }
    )
    for name, files, points in (("twice", 2, 40_000), ("many", 300, 18_000)):
        assert ends_well(done[name]).code == 0, done[name].stderr
        source = Stack.open(tmp_path / name).manifest.source
        assert (len(source.files), sum(file.points for file in source.files)) == (files, points)


def test_a_name_that_is_no_text_is_taken(scan: Path, tmp_path: Path) -> None:
    """File names are bytes: those of an old camera need not be UTF-8, and the manifest must be."""
    odd = os.fsencode(tmp_path) + b"/b\xff.npy"
    shutil.copyfile(os.fsencode(scan), odd)
    done = subprocess.run([*COMMAND, "build", odd, "-o", odd + b".out"], capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
    manifest = json.loads(Path(os.fsdecode(odd + b".out")).joinpath("manifest.json").read_text("utf-8"))
    assert manifest["source"]["files"][0]["name"] == "b\N{REPLACEMENT CHARACTER}.npy"


# --------------------------------------------------------------------------------------------- bad outputs


@pytest.mark.parametrize(
    "name", ["a" * 255, "\N{GRINNING FACE}" * 63, "\N{CJK UNIFIED IDEOGRAPH-4E00}" * 85], ids=len
)
def test_the_longest_names_work(scan: Path, tmp_path: Path, name: str) -> None:
    """The hidden folder beside the target must not need a longer name than the target has."""
    assert len(os.fsencode(name)) > 250
    build = ["build", str(scan), "-o", str(tmp_path / name), "--overwrite"]
    for again in ("new", "replaced"):
        assert run_all({again: build}, 1)[again].code == 0
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_places_that_cannot_be_are_one_line(scan: Path, tmp_path: Path) -> None:
    """Files, roots and names that no disk takes must be refused and stay as they are."""
    (tmp_path / "file").write_text("precious")
    (tmp_path / "loop").symlink_to("loop")
    before = sorted(tmp_path.iterdir())
    places = {
        str(tmp_path / "file"): "is a file",
        str(tmp_path / "loop"): "leads in a circle",
        str(tmp_path / ("n" * 256)): "file name too long",
        str(tmp_path / "new" / "folders" / ("n" * 256)): "file name too long",
        str(tmp_path / "file" / "out"): "file exists",
        ".": "not empty",
        "/": "not empty",
        "/ --overwrite": "other than a stack",
    }
    told = run_all({place: ["build", str(scan), "-o", *place.split(" ")] for place in places})
    for place, words in places.items():
        outcome = ends_well(told[place])
        assert (outcome.code, outcome.stdout) == (1, ""), place
        assert re.fullmatch(r"error: .+\n", outcome.stderr), outcome.stderr
        assert words in outcome.stderr
    assert sorted(tmp_path.iterdir()) == before, "something was left behind"
    assert (tmp_path / "file").read_text() == "precious"


def test_links_and_the_present_folder_are_followed(scan: Path, tmp_path: Path) -> None:
    """A dangling link says where the stack shall be; replacing the link itself would lose that."""
    (tmp_path / "link").symlink_to(tmp_path / "there")
    (tmp_path / "here").mkdir()
    assert stepfield("build", scan, "-o", tmp_path / "link").returncode == 0
    assert (tmp_path / "link").is_symlink()
    assert stepfield("build", scan, "-o", ".", cwd=tmp_path / "here").returncode == 0
    assert stepfield("build", scan, "-o", "", "--overwrite", cwd=tmp_path / "here").returncode == 0
    assert whole(tmp_path / "there")
    assert whole(tmp_path / "here")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["here", "link", "there"]


# -------------------------------------------------------------------------------------------- bad mounts


@pytest.fixture(scope="session")
def mounting() -> list[str]:
    """Return a prefix for commands that may mount what nobody else sees, or skip."""
    for rights in (["unshare", "-m"], ["unshare", "-Urm"]):
        probe = [*rights, "sh", "-c", "mount -t tmpfs tmpfs /mnt"]
        if shutil.which("unshare") and not subprocess.run(probe, capture_output=True, check=False).returncode:
            return rights
    pytest.skip("this machine lets no test mount a file system of its own")


def _in_mount(rights: list[str], place: Path, script: str, *arguments: object) -> str:
    """Run a script with the command as ``build``; return what it printed."""
    line = f'place="$1" scan="$2"; shift 2; build() {{ "$@" 2>&1 >/dev/null; echo "code $?"; }}\n{script}'
    command = [*rights, "bash", "-c", line, "bash", place, *arguments, *COMMAND, "build"]
    return subprocess.run(
        list(map(str, command)), capture_output=True, text=True, timeout=120, check=True
    ).stdout


def test_a_full_disk_keeps_the_old_stack(mounting: list[str], scan: Path, tmp_path: Path) -> None:
    """A stack that does not fit must leave the one that did, whole, and no half of its own."""
    told = _in_mount(
        mounting,
        tmp_path,
        f"""mount -t tmpfs -o size=96k tmpfs "$place"
        build "$@" "$scan" -o "$place/out" --cell 1; cat "$place"/out/* | md5sum
        build "$@" "$scan" -o "$place/out" --overwrite {" ".join(FINE)}; cat "$place"/out/* | md5sum
        build "$@" "$scan" -o "$place/new/folder" {" ".join(FINE)}; ls -A "$place" """,
        scan,
    )
    lines = [line for line in told.splitlines() if not line.startswith("warning: ")]
    first, before, error, second, after, another, third, names = lines
    assert (first, second, third, names) == ("code 0", "code 1", "code 1", "out")
    assert before == after
    assert "no space left" in error
    assert "no space left" in another


def test_a_read_only_disk_is_one_line(mounting: list[str], scan: Path, tmp_path: Path) -> None:
    """Camera sticks and network drives are often read-only, which folder rights do not show to root."""
    told = _in_mount(
        mounting,
        tmp_path,
        """mount --bind "$place" "$place" && mount -o remount,ro,bind "$place"
        build "$@" "$scan" -o "$place/out"; build "$@" "$scan" -o "$place/new/out"; ls -A "$place" """,
        scan,
    )
    first, code, second, again = told.splitlines()
    assert (code, again) == ("code 1", "code 1")
    assert "read-only" in first
    assert "read-only" in second


def test_a_mount_point_is_one_line(mounting: list[str], scan: Path, tmp_path: Path) -> None:
    """A folder that is a disk of its own cannot be moved over; nothing may be left beside it."""
    told = _in_mount(
        mounting,
        tmp_path,
        """mkdir "$place/out"; mount -t tmpfs tmpfs "$place/out"
        build "$@" "$scan" -o "$place/out" --cell 1; build "$@" "$scan" -o "$place/out/in" --cell 1
        ls -A "$place"; ls -A "$place/out" """,
        scan,
    )
    error, first, second, beside, inside = told.splitlines()
    assert (first, second, beside, inside) == ("code 1", "code 0", "out", "in")
    assert error.startswith("error: ")
    assert "busy" in error


# ------------------------------------------------------------------------------------------- bad streams


def _in_shell(line: str, *arguments: object) -> subprocess.CompletedProcess[str]:
    command = ["bash", "-c", line, "bash", *COMMAND, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)


@pytest.mark.parametrize("arguments", [["build"], ["info"], ["--help"], ["--version"]], ids=lambda a: a[0])
def test_closed_and_full_streams_never_show_a_traceback(
    scan: Path, tmp_path: Path, arguments: list[str]
) -> None:
    """A closed stream is nobody listening; a full one loses the result, which is a failure."""
    if arguments[0] in ("build", "info"):
        arguments = [*arguments, str(scan)]
    made = ["-o", tmp_path / "out", "--overwrite"] if arguments[0] == "build" else []
    before = scan.read_bytes()
    closed = _in_shell('"$@" >&- <&-', *arguments, *made)
    assert (closed.returncode, "Traceback" in closed.stderr) == (0, False), closed.stderr
    silent = _in_shell('"$@" >&- 2>&- <&-', *arguments, *made)
    assert silent.returncode == 0
    full = _in_shell('"$@" >/dev/full', *arguments, *made)
    lines = [line for line in full.stderr.splitlines() if not line.startswith("warning: ")]
    assert (full.returncode, len(lines)) == (1, 1), full.stderr
    assert "cannot be shown (no space left on device)" in lines[0]
    assert _in_shell('"$@" >/dev/full 2>/dev/full', *arguments, *made).returncode == 1
    assert scan.read_bytes() == before, "the output went into a file that took the stream's number"
    assert not made or whole(tmp_path / "out")


# ------------------------------------------------------------------------------------------- bad moments

#: Runs the command, but says so when it comes to a certain function, and may wait there for a line.
_ANNOUNCING = """
import importlib, sys
module = importlib.import_module(sys.argv[1])
name, wait = sys.argv[2:4]
original = getattr(module, name)
def announcing(*arguments, **keywords):
    sys.stderr.write("reached\\n"); sys.stderr.flush()
    setattr(module, name, original)
    if wait == "wait":
        sys.stdin.readline()
    return original(*arguments, **keywords)
setattr(module, name, announcing)
sys.argv[1:4] = []
from stepfield.cli import main
main()
"""


def _reached(module: str, function: str, wait: str, *arguments: object) -> subprocess.Popen[str]:
    """Start the command and return once it enters a function, where it goes on or waits to be killed."""
    running = subprocess.Popen(
        [sys.executable, "-c", _ANNOUNCING, module, function, wait, *map(str, arguments)],
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert running.stderr is not None
    assert running.stderr.readline() == "reached\n"
    return running


@pytest.fixture(scope="module")
def large(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """200 000 points, packed."""
    from stepfield.scan.write import write

    path = tmp_path_factory.mktemp("large") / "large.laz"
    write(path, np.random.default_rng(1).random((200_000, 3)) * [100, 100, 5], {})
    return path


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize(
    ("module", "function", "times"),
    [
        ("stepfield.scan.laz", "_decode_chunks", 40),
        ("stepfield.pipeline", "sort_into_compartments", 8),
        ("stepfield.stack.write", "describe", 1),  # over in no time, so it waits there
    ],
)
def test_an_interruption_at_any_stage_writes_nothing(
    large: Path, tmp_path: Path, module: str, function: str, times: int, number: signal.Signals
) -> None:
    """Reading and sorting run in native code; the signal must get through, and say so in one line."""
    out = tmp_path / "new" / "out"
    wait = "wait" if times == 1 else "go on"
    running = _reached(module, function, wait, "build", *[large] * times, "-o", out, "--cell", "0.1")
    running.send_signal(number)
    _, errors = running.communicate(timeout=60)
    assert running.returncode == 130, errors
    assert errors == "error: interrupted; nothing was written\n"
    assert list(tmp_path.iterdir()) == []


def test_a_killed_build_harms_nothing_and_its_leftovers_go(large: Path, tmp_path: Path) -> None:
    """Power cuts leave a hidden folder; it must neither stand for a stack nor stay for ever."""
    out = tmp_path / "out"
    assert stepfield("build", large, "-o", out, "--cell", 1).returncode == 0
    before = contents(out)
    running = _reached(
        "stepfield.stack.write", "describe", "wait", "build", large, "-o", out, "--overwrite", "--cell", 0.1
    )
    running.kill()
    running.communicate(timeout=60)
    assert contents(out) == before
    (leftover,) = (path for path in tmp_path.iterdir() if path != out)
    assert leftover.name.startswith(".out.stepfield-")
    _grow_old(leftover)
    assert stepfield("build", large, "-o", out, "--overwrite", "--cell", 2).returncode == 0
    assert whole(out)
    assert list(tmp_path.iterdir()) == [out]


def _grow_old(folder: Path) -> None:
    past = folder.stat().st_mtime - 2 * STALE
    os.utime(folder, (past, past))


def test_only_stale_leftovers_of_the_same_place_are_removed(scan: Path, tmp_path: Path) -> None:
    """A folder that another build is filling, or that is somebody's own, must stay."""
    names = (".out.stepfield-locked", ".out.stepfield-fresh", ".other.stepfield-old", ".out.original")
    locked, fresh, other, own = (tmp_path / name for name in names)
    stale = tmp_path / ".out.stepfield-stale"
    for folder in (locked, fresh, other, own, stale):
        folder.mkdir()
        (folder / "layer_00.png").write_text("half")
    for folder in (locked, other, own, stale):
        _grow_old(folder)
    holder = os.open(locked, os.O_RDONLY)
    try:
        fcntl.flock(holder, fcntl.LOCK_EX)
        assert stepfield("build", scan, "-o", tmp_path / "out").returncode == 0
    finally:
        os.close(holder)
    assert sorted(tmp_path.iterdir()) == sorted([tmp_path / "out", locked, fresh, other, own])


def _race(scan: Path, out: Path, cells: list[str], *extra: str) -> list[tuple[int, str]]:
    """Run builds of different sizes into one folder at once; return their codes and errors."""
    running = [
        subprocess.Popen(
            [*COMMAND, "build", str(scan), "-o", str(out), "--cell", cell, *extra],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        for cell in cells
    ]
    told = [process.communicate(timeout=60)[1] for process in running]
    return [(process.returncode, errors) for process, errors in zip(running, told, strict=True)]


def test_two_builds_at_once_without_overwrite_have_one_winner(scan: Path, tmp_path: Path) -> None:
    """The later one must be refused, not mixed in; its cells are another size, so a mix would show."""
    ends = _race(scan, tmp_path / "out", ["0.5", "0.01"])
    assert sorted(code for code, _ in ends) == [0, 1]
    (errors,) = (errors for code, errors in ends if code == 1)
    assert "not empty; use --overwrite" in errors.splitlines()[-1]
    assert whole(tmp_path / "out")
    assert len(list(tmp_path.iterdir())) == 1


def test_two_builds_at_once_with_overwrite_leave_one_whole_stack(scan: Path, tmp_path: Path) -> None:
    """The last to finish stays; the other's files must all be gone."""
    ends = _race(scan, tmp_path / "out", ["0.5", "0.01", "0.2"], "--overwrite")
    assert [code for code, _ in ends] == [0, 0, 0], ends
    assert whole(tmp_path / "out")
    assert len(list(tmp_path.iterdir())) == 1


def test_an_interruption_between_the_two_moves_brings_the_old_stack_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The old stack has stepped aside, the new one is not there yet: the worst moment there is."""
    from stepfield.stack.folder import new_folder

    out = tmp_path / "out"
    out.mkdir()
    (out / "old").touch()
    rename: Callable[[Path, Path], None] = os.rename
    calls: list[Path] = []

    def interrupted(source: Path, target: Path) -> None:
        calls.append(target)
        if len(calls) == 3:  # over the target, the old one aside, then the new one to its place
            raise KeyboardInterrupt
        rename(source, target)

    monkeypatch.setattr(os, "rename", interrupted)
    with pytest.raises(KeyboardInterrupt), new_folder(out, lambda _: True) as new:
        (new / "new").touch()
    assert [path.name for path in out.iterdir()] == ["old"]
    assert list(tmp_path.iterdir()) == [out]
