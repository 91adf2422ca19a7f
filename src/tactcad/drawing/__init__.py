"""What shop and assembler read on paper: part sheets, assembly sheets, pictures and assembly guides.

In: a design's parts and scenes, their solids as the kernel's text, the files that a part is made from. Out:
PDF, SVG and HTML as bytes, read back and compared with parts and bill of materials before they are released.
"""
