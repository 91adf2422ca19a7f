"""Whose release it is, and who answers for it: the design says it, or whoever releases."""

from __future__ import annotations

from dataclasses import replace

from tactcad.design.messages import InputError
from tactcad.design.tree import Design, Identity


def owned(design: Design, owner: str | None, contact: str | None, sample: bool) -> Design:
    """The design with the owner and contact that are given in place of its own.

    Raises InputError where one of them is unusable as text, or, but for a sample, there is none.
    """
    given = {"organisation": ("--owner", owner), "contact": ("--contact", contact)}
    specs = Identity.__dataclass_fields__
    texts = {
        name: specs[name].metadata["spec"].read(text, option)
        for name, (option, text) in given.items()
        if text is not None
    }
    identity = replace(design.design, **texts)
    missing = [name for name in given if getattr(identity, name) is None]
    if missing and not sample:
        raise InputError(
            " and ".join(f"design.{name}" for name in missing),
            f"{design.name} does not say whose release it is",
            legal=f"in [design], or {' and '.join(given[name][0] for name in missing)}; "
            "or --sample, which is not for order",
        )
    return replace(design, design=identity)
