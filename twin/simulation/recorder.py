"""Machine time, spindle angle and sums of a replay, and the records that they make."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from gcode.events import Block, Event, ToolChange
from twin.arrays import FloatArray
from twin.motion.path import Move
from twin.record import Collision, CollisionKind, ForceSamples, NcEvent, RunSummary, Step
from twin.simulation.clock import UNSAMPLED, SpindleClock, Turned
from twin.simulation.contacts import Contact, collision_record, point
from twin.simulation.material import Material
from twin.simulation.nc_events import nc_event
from twin.simulation.solve import IN_AIR, Solved
from twin.simulation.tools import ToolSetup
from twin.simulation.totals import Totals


class Recorder:
    """Makes the records of a replay in order; time goes on with each step and tool change.

    Args:
        tools: by number.
        samples_per_revolution: force samples per spindle revolution.
        tool_change_s: time of one tool change.
        program: name of the NC program, for messages.

    Attributes:
        t_s: machine time from program start.
        clock: turns with the spindle.
    """

    def __init__(
        self, tools: Mapping[int, ToolSetup], *, samples_per_revolution: int, tool_change_s: float, program: str
    ) -> None:
        self.t_s = 0.0
        self.clock = SpindleClock(samples_per_revolution)
        self._samples_per_revolution = samples_per_revolution
        self._tool_change_s = tool_change_s
        self._program = program
        self._descriptions = {number: tool.description for number, tool in tools.items()}
        self._without_forces = {number for number, tool in tools.items() if tool.forces is None}
        self._without_shank = {number for number, tool in tools.items() if tool.shank_assumed}
        self._totals = Totals(self._descriptions)
        self._steps = 0

    def samples_in(self, duration_s: float, spindle_rpm: float) -> float:
        """How many force samples a duration has, about."""
        return duration_s * abs(spindle_rpm) / 60.0 * self._samples_per_revolution

    def event(self, event: Event) -> NcEvent:
        """The record of an event that is not a motion."""
        if isinstance(event, Block):
            self._totals.set_block(event.place.text)
        if isinstance(event, ToolChange):
            self.t_s += self._tool_change_s
            self._totals.add_time(self.t_s)
        return nc_event(event, self.t_s, self._descriptions)

    def turned(self, t_s: float, duration_s: float, move: Move, *, ends_only: bool = False) -> Turned:
        """Turn the spindle during a part of a motion; its samples, none for a tool without a force model.

        Args:
            t_s: machine time at the beginning.
            ends_only: see `SpindleClock.advance`.
        """
        if move.tool in self._without_forces:
            self.clock.turn(duration_s, move.spindle_rpm)
            return UNSAMPLED
        return self.clock.advance(t_s, duration_s, move.spindle_rpm, ends_only=ends_only)

    def turns(self, t_s: float, step_s: float, move: Move) -> Iterator[Turned]:
        """The samples of equal steps of a motion, one after another without end; the clock is at the last one taken.

        Args:
            t_s: machine time at the beginning of the first step.
            step_s: duration of each.
        """
        while True:
            yield self.turned(t_s, step_s, move)
            t_s += step_s

    def air_step(self, move: Move, start_mm: FloatArray, end_mm: FloatArray, duration_s: float) -> Step:
        """The record of a step that cuts nothing: the spindle turns on."""
        turned = self.turned(self.t_s, duration_s, move, ends_only=True)
        return self.step(move, start_mm, end_mm, duration_s, turned, IN_AIR)

    def step(
        self,
        move: Move,
        start_mm: FloatArray,
        end_mm: FloatArray,
        duration_s: float,
        turned: Turned,
        solved: Solved,
    ) -> Step:
        """The record of one step of a motion.

        Args:
            turned: times and spindle angles of its samples.
            solved: its engagement and forces.
        """
        step = Step(
            index=self._steps,
            t_s=self.t_s,
            duration_s=duration_s,
            start_mm=point(start_mm),
            end_mm=point(end_mm),
            nc_line=move.nc_line,
            tool=move.tool,
            rapid=move.rapid,
            feed_mm_min=move.feed_mm_min,
            spindle_rpm=move.spindle_rpm,
            engagement=solved.engagement,
            samples=_NO_SAMPLES if turned is UNSAMPLED else _samples(turned, solved.loads, move),
        )
        self._steps += 1
        self.t_s += duration_s
        speed = abs(move.spindle_rpm) * self._samples_per_revolution
        sample_s = 60.0 / speed if speed else 0.0
        self._totals.add_step(step, sample_s)
        return step

    def collisions(self, contacts: Mapping[CollisionKind, Contact], move: Move) -> Iterator[Collision]:
        """The records of a motion's collisions."""
        for kind, contact in contacts.items():
            self._totals.collisions += 1
            yield collision_record(kind, contact, move, self._program, shank_assumed=move.tool in self._without_shank)

    def summary(self, material: Material, *, complete: bool) -> RunSummary:
        """Sums, peaks and digest so far."""
        areas = tuple(material.workpiece.areas_mm2(axis) for axis in range(3))
        return self._totals.summary(complete=complete, areas_mm2=areas, removed_mm3=material.removed_mm3)


def _samples(turned: Turned, loads: FloatArray | None, move: Move) -> ForceSamples:
    """Force samples of a step; in air the first and the last only."""
    times, angles = turned
    if loads is None:
        keep = [0, -1] if len(times) > 2 else slice(None)
        times, angles = times[keep], angles[keep]
        loads = np.zeros((len(times), 4))
    torque_nm = loads[:, 3] * 1e-3
    return ForceSamples(
        t_s=times,
        spindle_angle_rad=angles,
        force_n=loads[:, :3],
        torque_nm=torque_nm,
        power_w=torque_nm * abs(move.spindle_rpm) * (2.0 * math.pi / 60.0),
    )


_NO_SAMPLES = ForceSamples(
    t_s=np.zeros(0),
    spindle_angle_rad=np.zeros(0),
    force_n=np.zeros((0, 3)),
    torque_nm=np.zeros(0),
    power_w=np.zeros(0),
)
