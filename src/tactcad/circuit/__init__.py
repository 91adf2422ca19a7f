"""The circuit that reads the array: gauges in bridges, switches, multiplexers, amplifiers, as one netlist.

In: a layout. Out: the netlist, and from it KiCad's file, a table, a SPICE deck, and the list of leads to cut.
"""
