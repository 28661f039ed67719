"""What the command can do. Heavy modules load inside each command, so that help answers at once."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

import stepfield
from stepfield.cli.options import with_parameters
from stepfield.cli.report import Reporter
from stepfield.targets import NAMES

application = typer.Typer(
    help="Turn laser scans of rough, multi-level terrain into layered height-maps for robot simulators.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # drawing boxes around the help takes longer to load than all the rest of it
    context_settings={"help_option_names": ["-h", "--help"]},
)

Scans = Annotated[list[Path], typer.Argument(metavar="SCAN", help="Files of one scan.", show_default=False)]
MaybeScans = Annotated[
    list[Path] | None, typer.Argument(metavar="SCAN", help="Files of one scan.", show_default=False)
]
Targets = Annotated[
    list[str] | None,
    typer.Option("--target", metavar="NAME", help=f"Write for {', '.join(NAMES)} (repeatable)."),
]
Thicken = Annotated[
    float | None,
    typer.Option("--thicken", metavar="M", help="Close the targets' meshes, so thick.", show_default=False),
]
Decimate = Annotated[
    float | None,
    typer.Option("--decimate", metavar="M", help="Error of the decimated meshes.", show_default=False),
]
Reconstructed = Annotated[
    str | None,
    typer.Option(
        "--reconstruction",
        metavar="edges|simulator",
        help="Surface of the meshes. (default: as built)",
        show_default=False,
    ),
]
AsJson = Annotated[bool, typer.Option("--json", metavar="", help="Print one JSON object.")]
Debug = Annotated[bool, typer.Option("--debug", metavar="", help="Show the traceback of a failure.")]


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"stepfield {stepfield.__version__}")
        raise typer.Exit


@application.callback()
def stepfield_command(
    version: Annotated[
        bool,
        typer.Option("--version", metavar="", callback=_version, is_eager=True, help="Show the version."),
    ] = False,
) -> None:
    """Hold what all commands share."""


@application.command()
@with_parameters
def build(
    scans: MaybeScans = None,
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="DIR", help="Folder of the stack.", show_default=False)
    ] = ...,  # type: ignore[assignment]
    project: Annotated[
        Path | None, typer.Option("--project", metavar="FILE", help="Project file in place of scans.")
    ] = None,
    target: Targets = None,
    thicken: Thicken = None,
    decimate: Decimate = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", metavar="", help="Replace an older stack.")
    ] = False,
    as_json: AsJson = False,
    debug: Debug = False,
    *,
    given: dict[str, Any],
) -> None:
    """Build a stack of height-maps from a scan."""
    from stepfield.cli.build import build_stack
    from stepfield.cli.targets import Wanted

    wanted = Wanted.checked(target or [], thicken, decimate)
    build_stack(scans or [], project, output, given, wanted, overwrite=overwrite, reporter=Reporter(as_json))


@application.command()
def export(
    source: Annotated[
        Path, typer.Argument(metavar="PROJECT|STACK", help="Project file, or folder of a stack.")
    ],
    output: Annotated[
        Path,
        typer.Option("-o", "--output", metavar="DIR", help="Gets a folder a target.", show_default=False),
    ],
    target: Targets = None,
    thicken: Thicken = None,
    decimate: Decimate = None,
    reconstruction: Reconstructed = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", metavar="", help="Replace older folders of targets.")
    ] = False,
    as_json: AsJson = False,
    debug: Debug = False,
) -> None:
    """Write the files of simulators and other programs from a stack."""
    from stepfield.cli.export import export_targets
    from stepfield.cli.targets import Wanted

    wanted = Wanted.checked(target or [], thicken, decimate, reconstruction)
    export_targets(source, output, wanted, overwrite=overwrite, reporter=Reporter(as_json))


@application.command()
@with_parameters
def view(
    scans: MaybeScans = None,
    screenshot: Annotated[
        Path | None,
        typer.Option("--screenshot", metavar="FILE.png", help="Draw it all, save a picture, leave."),
    ] = None,
    size: Annotated[
        str | None,
        typer.Option("--size", metavar="WxH", help="Size of the window in pixels.", show_default=False),
    ] = None,
    theme: Annotated[
        str | None,
        typer.Option(
            "--theme",
            metavar="dark|light",
            help="Look of the window. (default: the system's)",
            show_default=False,
        ),
    ] = None,
    debug: Debug = False,
    *,
    given: dict[str, Any],
) -> int:
    """Open the window."""
    from stepfield.cli.view import open_window

    return open_window(scans or [], given, screenshot=screenshot, size=size, theme=theme)


@application.command()
@with_parameters
def info(scans: Scans, as_json: AsJson = False, debug: Debug = False, *, given: dict[str, Any]) -> None:
    """Say what a scan holds and which parameters suit it."""
    from stepfield.cli.info import describe_scan

    describe_scan(scans, given, Reporter(as_json))


@application.command()
def synth(
    scene: Annotated[
        str, typer.Argument(metavar="SCENE|FILE.json", help="Name of a scene or its description.")
    ],
    output: Annotated[
        Path,
        typer.Option("-o", "--output", metavar="FILE", help="PLY, LAS ... by suffix.", show_default=False),
    ],
    points: Annotated[
        int | None, typer.Option(metavar="N", help="Number of points.", show_default=False)
    ] = None,
    noise: Annotated[
        float | None, typer.Option(metavar="M", help="Standard deviation in metres.", show_default=False)
    ] = None,
    seed: Annotated[int, typer.Option(metavar="N", help="Another number, another cloud.")] = 0,
    scanner: Annotated[
        bool, typer.Option("--scanner", metavar="", help="See the scene as a laser scanner would.")
    ] = False,
    as_json: AsJson = False,
    debug: Debug = False,
) -> None:
    """Make a synthetic scan whose true surfaces are known."""
    from stepfield.cli.synth import write_scene

    write_scene(scene, output, points, noise, seed, scanner=scanner, reporter=Reporter(as_json))


@application.command()
def simulate(
    stacks: Annotated[
        list[Path], typer.Argument(metavar="STACK", help="Folders of stacks of one scan.", show_default=False)
    ],
    truth: Annotated[
        str | None,
        typer.Option(
            "--truth", metavar="MESH|SCENE", help="True surface, to compare with.", show_default=False
        ),
    ] = None,
    scan: Annotated[
        list[Path] | None,
        typer.Option("--scan", metavar="SCAN", help="Compare costs with a mesh of it.", show_default=False),
    ] = None,
    start: Annotated[
        str | None,
        typer.Option(
            "--start", metavar="X,Y,HEADING[,Z]", help="Metres; degrees from east.", show_default=False
        ),
    ] = None,
    commands: Annotated[
        str | None,
        typer.Option(
            "--commands", metavar="S,M/S,DEG/S;...", help="What the robot does.", show_default=False
        ),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option("--picture", metavar="FILE.png", help="Save a strip of moments.", show_default=False),
    ] = None,
    viewer: Annotated[
        bool, typer.Option("--viewer", metavar="", help="Open MuJoCo's viewer at the end.")
    ] = False,
    as_json: AsJson = False,
    debug: Debug = False,
) -> None:
    """Drive a robot on stacks and on the truth, and compare."""
    from stepfield.cli.simulate import Wish, simulate_stacks

    wish = Wish(tuple(stacks), truth, tuple(scan or ()), start, commands, picture, viewer)
    simulate_stacks(wish, Reporter(as_json))


@application.command()
def check(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of the stack.")],
    scan: Annotated[
        list[Path] | None,
        typer.Option("--scan", metavar="SCAN", help="Compare with its scan.", show_default=False),
    ] = None,
    truth: Annotated[
        str | None,
        typer.Option(
            "--truth",
            metavar="MESH|SCENE",
            help="True surface, to compare with: a mesh, a scene or its JSON.",
            show_default=False,
        ),
    ] = None,
    as_json: AsJson = False,
    debug: Debug = False,
) -> int:
    """Check that a stack is whole and true."""
    from stepfield.cli.check import check_folder

    return check_folder(folder, scan or [], truth, Reporter(as_json))
