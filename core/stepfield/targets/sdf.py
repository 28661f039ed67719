"""SDFormat: models of one static shape each, and a world of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from stepfield.targets.text import in_xml, numbers

#: Known to every Gazebo since Fortress.
VERSION = "1.9"
#: Red, green and blue of the layers, in turn.
COLOURS = ((0.55, 0.55, 0.52), (0.35, 0.55, 0.75), (0.80, 0.60, 0.35), (0.50, 0.70, 0.45), (0.70, 0.50, 0.65))


@dataclass(frozen=True)
class MeshShape:
    """A mesh, in the coordinates of the world."""

    uri: str


@dataclass(frozen=True)
class Heightmap:
    """A height-map.

    Attributes
    ----------
    uri : str
    middle : tuple of float
        Where its centre is in plan, and its lowest pixel in height; metres.
    seen, touched : float
        Length of its sides for what is seen and for the physics, metres.
    height : float
        Of the brightest pixel above black, metres.
    """

    uri: str
    middle: tuple[float, float, float]
    seen: float
    touched: float
    height: float


@dataclass(frozen=True)
class Model:
    """A static model.

    Attributes
    ----------
    name : str
        A word: of its folder, too.
    title : str
        For people; anything.
    number : int
        Chooses its colour.
    shape : MeshShape or Heightmap
    """

    name: str
    title: str
    number: int
    shape: MeshShape | Heightmap


def model(made: Model) -> str:
    """Return model.sdf."""
    colour = numbers(COLOURS[made.number % len(COLOURS)])
    if isinstance(made.shape, MeshShape):
        pose, touched = "0 0 0 0 0 0", _mesh(made.shape)
        seen = touched
    else:
        # The position is said twice: what is seen heeds <pos> alone, the physics <pose> alone.
        pose = f"{numbers(made.shape.middle)} 0 0 0"
        seen = _heightmap(made.shape, made.shape.seen)
        touched = _heightmap(made.shape, made.shape.touched)
    return f"""<?xml version="1.0"?>
<sdf version="{VERSION}">
  <model name="{in_xml(made.name)}">
    <static>true</static>
    <link name="link">
      <collision name="collision">
        <pose>{pose}</pose>
        <geometry>{touched}</geometry>
      </collision>
      <visual name="visual">
        <geometry>{seen}</geometry>
        <material>
          <double_sided>true</double_sided>
          <ambient>{colour} 1</ambient>
          <diffuse>{colour} 1</diffuse>
          <specular>0.05 0.05 0.05 1</specular>
        </material>
      </visual>
    </link>
  </model>
</sdf>
"""


def _mesh(shape: MeshShape) -> str:
    return f"<mesh><uri>{in_xml(shape.uri)}</uri></mesh>"


def _heightmap(shape: Heightmap, side: float) -> str:
    return (
        f"<heightmap><uri>{in_xml(shape.uri)}</uri>"
        f"<size>{numbers((side, side, shape.height))}</size>"
        f"<pos>{numbers(shape.middle)}</pos>"
        f"<sampling>1</sampling></heightmap>"
    )


def config(made: Model, description: str) -> str:
    """Return model.config."""
    return f"""<?xml version="1.0"?>
<model>
  <name>{in_xml(made.name)}</name>
  <version>1.0</version>
  <sdf version="{VERSION}">model.sdf</sdf>
  <author><name>stepfield</name></author>
  <description>{in_xml(description)}</description>
</model>
"""


def world(name: str, models: Sequence[Model]) -> str:
    """Return a world that includes models where they are, with a sun; its name, a word, is in its topics."""
    includes = "".join(
        f"""    <include>
      <uri>model://{in_xml(each.name)}</uri>
      <name>{in_xml(each.name)}</name>
      <pose>0 0 0 0 0 0</pose>
    </include>
"""
        for each in models
    )
    return f"""<?xml version="1.0"?>
<sdf version="{VERSION}">
  <world name="{in_xml(name)}">
    <physics name="physics" type="ignored">
      <max_step_size>0.001</max_step_size>
      <real_time_factor>1</real_time_factor>
      <!-- With its default, ode, things fall through height-maps. -->
      <dart><collision_detector>bullet</collision_detector></dart>
    </physics>
    <light name="sun" type="directional">
      <cast_shadows>true</cast_shadows>
      <pose>0 0 100 0 0 0</pose>
      <diffuse>0.9 0.9 0.9 1</diffuse>
      <specular>0.2 0.2 0.2 1</specular>
      <direction>-0.5 0.3 -0.9</direction>
    </light>
{includes}  </world>
</sdf>
"""
