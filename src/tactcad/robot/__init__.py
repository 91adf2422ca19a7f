"""The sensor in a robot: URDF, MJCF and a table of taxels, and joint positions back to force and K_obj.

In: a design, or its exported table. Its family declares the moving parts and joints (`mechanism`); every file
follows from that.
"""

from .felt import Felt, read
from .taxel_table import Taxels, read_taxels

__all__ = ["Felt", "Taxels", "read", "read_taxels"]
