"""Run by the Python that KiCad 6 comes with: opens a board, writes KiCad's report of its rules to a file, and
prints what stands on which net as JSON; with a folder, plots the copper there as KiCad would.
"""

from __future__ import annotations

import json
import sys

import pcbnew

board = pcbnew.LoadBoard(sys.argv[1])
pcbnew.WriteDRCReport(board, sys.argv[2], pcbnew.EDA_UNITS_MILLIMETRES, True)
pins = {}
for footprint in board.GetFootprints():
    for pad in footprint.Pads():
        if pad.GetNumber():
            pins[f"{footprint.GetReference()}.{pad.GetNumber()}"] = pad.GetNetname()
json.dump(pins, sys.stdout)
if len(sys.argv) > 3:
    plots = pcbnew.PLOT_CONTROLLER(board)
    options = plots.GetPlotOptions()
    options.SetOutputDirectory(sys.argv[3])
    options.SetUseGerberX2format(True)
    options.SetDrillMarksType(0)  # none
    for layer in (pcbnew.F_Cu, pcbnew.In1_Cu, pcbnew.In2_Cu, pcbnew.B_Cu):
        plots.SetLayer(layer)
        plots.OpenPlotfile(board.GetLayerName(layer).replace(".", "_"), pcbnew.PLOT_FORMAT_GERBER, "")
        plots.PlotLayer()
    plots.ClosePlot()
