"""Manual linear stages as they are sold: size, hole pattern, travel."""

from __future__ import annotations

from dataclasses import dataclass

from .tables import number, rows


@dataclass(frozen=True)
class Stage:
    """Two square plates of `size` and thickness `plate`, M4 at +-`hole`, moving +-`travel` (mm).

    maker, part_no: where the row was read in the maker's own data (`verified`), else empty.
    """

    size: float
    plate: float
    hole: float
    travel: float
    maker: str = ""
    part_no: str = ""
    verified: bool = False

    @property
    def height(self) -> float:
        return 2 * self.plate


STAGES = tuple(
    Stage(
        **{name: number(row[name]) for name in ("size", "plate", "hole", "travel")},
        maker=row["maker"],
        part_no=row["part_no"],
        verified=row["verified"] == "true",
    )
    for row in rows("stages")
)
