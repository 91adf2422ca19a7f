"""Cells in a plane: islands on four foil beams, of two alternating stiffnesses, each with a magnet over a
three-axis Hall chip (the paper's Figure 1(b))."""

from __future__ import annotations

from tactcad.design.family import (
    Family,
    FamilyBoards,
    FamilyEstimate,
    FamilyPads,
    FamilyReadings,
    FamilyRobot,
    FamilyStack,
    FamilyTargets,
    Late,
)

from .cell_tables import PlanarDesign

HERE = "tactcad.families.planar"
FAMILY = Family(
    name="planar",
    spec=PlanarDesign,
    layout=Late(f"{HERE}.cell_layout:PlanarLayout"),
    about=Late(f"{HERE}.parts:about"),
    parts=Late(f"{HERE}.parts:measured"),
    scenes=f"{HERE}.rigs",
    rules=Late(f"{HERE}.rules:design_rules"),
    estimate=FamilyEstimate(
        rows=Late(f"{HERE}.sensor:rows"),
        run=Late(f"{HERE}.sensor:run"),
        golden=Late(f"{HERE}.sensor:golden"),
        strength=Late(f"{HERE}.sensor:strength"),
        strain=None,
    ),
    plans={
        "element": Late(f"{HERE}.cell_plan:cell_plan"),
        "cells": Late(f"{HERE}.cell_plan:cell_plan"),
        "array": Late(f"{HERE}.cell_plan:pad_places"),
    },
    stack=FamilyStack(
        limits=Late(f"{HERE}.cell_array:limits"),
        built=Late(f"{HERE}.cell_array:Stacked"),
        figures=Late(f"{HERE}.cell_array:figures"),
        elements=Late("tactcad.scenes.rig:none"),
    ),
    pads=FamilyPads(
        places=Late(f"{HERE}.cell_pads:places"),
        springs=Late(f"{HERE}.cell_pads:springs"),
        limit=Late(f"{HERE}.cell_pads:limit"),
        unit=("mT", "uT"),
    ),
    readout=None,
    readings=FamilyReadings(
        calibrate=Late(f"{HERE}.cell_commands:calibrate"), stiffness=Late(f"{HERE}.cell_commands:stiffness")
    ),
    variables=None,
    targets=FamilyTargets(
        design=Late(f"{HERE}.cell_answers:design"), tables=Late(f"{HERE}.cell_targets:tables")
    ),
    checks=f"{HERE}.checks",
    robot=FamilyRobot(
        mechanism=Late(f"{HERE}.cell_joints:cells"), jobs=Late("tactcad.robot.robot_files:jobs")
    ),
    boards=FamilyBoards(made=Late(f"{HERE}.cell_board:made"), supplies=Late(f"{HERE}.cell_board:supplies")),
)
