"""STEP files read as text by a parser of our own, by the kernel, and after being tampered with."""

from __future__ import annotations

import random
import re

import numpy as np
import pytest
from part21 import Text

from tactcad.design.messages import CheckFailure
from tactcad.export import step_file as step
from tactcad.export.step_text import Header, canonical

pytestmark = pytest.mark.cad

HEADER = Header("macro", "an array", "B", "2026-11-21", "J\u00f6rg O'Neil \u6d4b \U0001f600", "A\\B \u0141ab")


@pytest.fixture(scope="module")
def assembly(macro_scene, macro_shapes) -> bytes:
    return step.scene_step(macro_scene, macro_shapes, HEADER)


def test_a_part_is_one_product_and_no_assembly(macro_scene, macro_shapes):
    for part in macro_scene.parts:
        text = Text(step.part_step(part, macro_shapes[part.part_no], HEADER))
        assert [text.words(n)[0] for n in text.of("PRODUCT")] == [part.part_no]
        assert text.of("NEXT_ASSEMBLY_USAGE_OCCURRENCE") == []
        assert len(text.of("MANIFOLD_SOLID_BREP")) == 1
        assert "AUTOMOTIVE_DESIGN" in text.text
        assert re.search(r"SI_UNIT\(\.MILLI\.,\.METRE\.\)", text.text)


def test_an_assembly_shares_its_prototypes(macro_scene, assembly):
    text = Text(assembly)
    products = [text.words(n)[0] for n in text.of("PRODUCT")]
    assert sorted(products) == sorted(["macro", *(p.part_no for p in macro_scene.parts)])
    assert len(text.of("MANIFOLD_SOLID_BREP")) == len(macro_scene.parts) < len(macro_scene.placements)
    assert len(text.of("NEXT_ASSEMBLY_USAGE_OCCURRENCE")) == len(macro_scene.placements)


def test_every_instance_stands_where_the_scene_says(macro_scene, assembly):
    placed = Text(assembly).placements()
    assert set(placed) == {p.designator for p in macro_scene.placements}
    for p in macro_scene.placements:
        product, matrix = placed[p.designator]
        meant = np.vstack([np.column_stack([np.array(p.rotation, float), p.origin]), [0, 0, 0, 1]])
        assert product == p.part.part_no
        assert np.abs(matrix - meant).max() < 1e-9, p.designator


def test_colours_are_written_as_srgb(macro_scene, macro_shapes, assembly):
    for part in macro_scene.parts:
        text = Text(step.part_step(part, macro_shapes[part.part_no], HEADER))
        (colour,) = text.of("COLOUR_RGB")
        meant = [int(part.colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
        assert text.numbers(colour) == pytest.approx(meant, abs=1e-6)
    text = Text(assembly)
    written = {tuple(np.round(np.array(text.numbers(n)) * 255).astype(int)) for n in text.of("COLOUR_RGB")}
    assert written == {tuple(int(p.colour[i : i + 2], 16) for i in (1, 3, 5)) for p in macro_scene.parts}


def test_colours_read_back_through_the_kernel(macro_scene, assembly, tmp_path):
    from OCP.Quantity import Quantity_Color, Quantity_TOC_sRGB
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_ColorSurf, XCAFDoc_ColorTool, XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

    from tactcad.solids.occt import TDF_LabelSequence

    path = tmp_path / "a.step"
    path.write_bytes(assembly)
    document = TDocStd_Document(TCollection_ExtendedString("BinXCAF"))
    reader = STEPCAFControl_Reader()
    reader.SetColorMode(True)
    reader.SetNameMode(True)
    reader.ReadFile(str(path))
    reader.Transfer(document)
    labels = TDF_LabelSequence()
    XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).GetShapes(labels)
    seen = {}
    for i in range(1, labels.Length() + 1):
        colour = Quantity_Color()
        label = labels.Value(i)
        if not XCAFDoc_ShapeTool.IsAssembly_s(label) and XCAFDoc_ColorTool.GetColor_s(
            label, XCAFDoc_ColorSurf, colour
        ):
            seen[step._name_of(label)] = [round(255 * v) for v in colour.Values(Quantity_TOC_sRGB)]
    assert seen == {p.part_no: [int(p.colour[i : i + 2], 16) for i in (1, 3, 5)] for p in macro_scene.parts}


def test_the_header_says_who_and_when_in_ascii(assembly):
    text = assembly.decode("ascii")
    assert "'2026-11-21T00:00:00'" in text
    assert "'revision B'" in text
    author = re.search(r"FILE_NAME\('macro','[^']*',\(('(?:[^']|'')*')\),\(('(?:[^']|'')*')\)", text)

    def decoded(word: str) -> str:
        word = word[1:-1].replace("''", "'")
        word = re.sub(r"\\X2\\([0-9A-F]+)\\X0\\", lambda m: bytes.fromhex(m[1]).decode("utf-16-be"), word)
        word = re.sub(r"\\X4\\([0-9A-F]+)\\X0\\", lambda m: bytes.fromhex(m[1]).decode("utf-32-be"), word)
        return word.replace("\\\\", "\\")

    assert (decoded(author[1]), decoded(author[2])) == (HEADER.author, HEADER.organisation)


def test_other_software_reads_the_assembly(macro_scene, assembly, tmp_path):
    """build123d's importer, which knows nothing of how it was written: solids, volume and box of the
    whole."""
    from build123d import import_step

    path = tmp_path / "a.step"
    path.write_bytes(assembly)
    solids = import_step(str(path)).solids()
    assert len(solids) == len(macro_scene.placements)
    assert sum(s.volume for s in solids) == pytest.approx(
        sum(p.part.volume for p in macro_scene.placements), rel=1e-7
    )


# --- canonical text ---


def entities(text: str) -> list[tuple[int, str]]:
    return [(int(n), body) for n, body in re.findall(r"^#(\d+)=(.*);$", text, re.MULTILINE)]


def rebuilt(pairs) -> str:
    return (
        "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n"
        + "".join(f"#{n} = {body};\n" for n, body in pairs)
        + "ENDSEC;\n"
    )


def renumbered(pairs, number):
    swap = lambda m: m[0] if m[1] is None else f"#{number(int(m[1]))}"  # noqa: E731
    return [(number(n), re.sub(r"'(?:[^']|'')*'|#(\d+)", swap, body)) for n, body in pairs]


def test_canonical_text_does_not_depend_on_order_or_numbers(assembly):
    text = assembly.decode("ascii")
    pairs = entities(text)
    assert canonical(rebuilt(pairs), HEADER) == text
    shuffled = random.Random(1).sample(pairs, len(pairs))
    assert canonical(rebuilt(shuffled), HEADER) == text
    assert canonical(rebuilt(renumbered(shuffled, lambda n: 3 * n + 1000)), HEADER) == text


def test_canonical_text_does_not_depend_on_the_order_of_styles(macro_scene, assembly):
    """The kernel writes one list of styled items a prototype, ordered by memory address: numbers change
    places."""
    text = assembly.decode("ascii")
    pairs = entities(text)
    styles = [n for n, body in pairs if body.startswith("MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION")]
    assert len(styles) == len(macro_scene.parts)
    new = dict(zip(styles, random.Random(2).sample(styles, len(styles))))
    mixed = [(new.get(n, n), body) for n, body in pairs]
    assert mixed != pairs
    assert canonical(rebuilt(mixed), HEADER) == text


def test_text_that_looks_like_references_is_left_alone():
    pairs = [(1, "PRODUCT('it''s #2; really','',#7)"), (7, "APPLICATION_CONTEXT('a;b#1')")]
    got = canonical(rebuilt(pairs), HEADER)
    assert "#1=PRODUCT('it''s #2; really','',#2);" in got
    assert "#2=APPLICATION_CONTEXT('a;b#1');" in got


# --- read back ---


def change_first(pattern: str, new: str):
    def tamper(data: bytes) -> bytes:
        changed, count = re.subn(pattern, new, data.decode("ascii"), count=1)
        assert count == 1
        return changed.encode("ascii")

    return tamper


def move_an_instance(data: bytes) -> bytes:
    """One instance's place moves by a micrometre."""
    text = Text(data)
    shape = text.of("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION")[7]
    line = text.entities[text.references(shape)[0]]
    operator = int(re.search(r"WITH_TRANSFORMATION\s*\(\s*#(\d+)", line)[1])
    point = text.references(text.references(operator)[1])[0]
    x, y, z = text.numbers(point)
    old = f"#{point}={text.entities[point]};"
    assert text.text.count(old) == 1
    return text.text.replace(old, f"#{point}=CARTESIAN_POINT('',({x + 0.001:.6f},{y:.6f},{z:.6f}));").encode(
        "ascii"
    )


SCENE_TAMPERING = {
    "an instance moved": move_an_instance,
    "a designator changed": change_first(r"OCCURRENCE\('E3','E3'", "OCCURRENCE('E33','E33'"),
    "a product renamed": change_first(
        r"(PRODUCT\('macro-array-spacer',)'macro-array-spacer'", r"\1'macro-array-spacers'"
    ),
    "the assembly renamed": change_first(r"(PRODUCT\('macro',)'macro'", r"\1'micro'"),
    "a radius changed": change_first(r"(CYLINDRICAL_SURFACE\('',#\d+,)1\.5(\d*)\)", r"\g<1>1.4\2)"),
    "cut off": lambda data: data[: len(data) // 2],
    "emptied": lambda data: b"",
}


@pytest.mark.by_day(3, "an assembly by the kernel each")
@pytest.mark.parametrize("name", SCENE_TAMPERING)
def test_a_tampered_assembly_is_not_let_out(name, macro_scene, macro_shapes, monkeypatch):
    write = step.written
    monkeypatch.setattr(step, "written", lambda *args: SCENE_TAMPERING[name](write(*args)))
    with pytest.raises(CheckFailure):
        step.scene_step(macro_scene, macro_shapes, HEADER)


def test_a_part_of_other_volume_is_not_let_out(macro_scene, macro_shapes):
    """The shape of another element under this part's number: one solid, valid, and wrong."""
    a4, a5 = (next(p for p in macro_scene.parts if p.part_no.endswith(f"-a{n}mm")) for n in (4, 5))
    with pytest.raises(CheckFailure, match="volumes"):
        step.part_step(a4, macro_shapes[a5.part_no], HEADER)


def test_a_moved_part_is_still_one_product(macro_scene, macro_shapes):
    """A located shape would come out as an assembly of one, which is refused, or with its place baked in."""
    from tactcad.solids.occt import placed_shape

    part = macro_scene.parts[0]
    moved = placed_shape(macro_shapes[part.part_no], (10.0, 0.0, 0.0), ((1, 0, 0), (0, 1, 0), (0, 0, 1)))
    try:
        data = step.part_step(part, moved, HEADER)
    except CheckFailure:
        return
    assert Text(data).of("NEXT_ASSEMBLY_USAGE_OCCURRENCE") == []


def test_two_parts_in_a_part_file_are_refused(macro_scene, macro_shapes):
    from build123d import Compound, Solid

    part = macro_scene.parts[0]
    two = Compound([Solid(macro_shapes[part.part_no]), Solid.make_box(1, 1, 1)])
    with pytest.raises(CheckFailure):
        step.part_step(part, two.wrapped, HEADER)


def test_styles_of_two_equal_solids_stand_in_the_order_of_their_products():
    """The kernel writes them by memory address: an export on one core and one on two differed."""

    def text(first: int, second: int) -> str:
        style = "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION"
        return (
            "DATA;\n#1=PRODUCT('a',#3);\n#2=PRODUCT('b',#4);\n#3=SOLID('');\n#4=SOLID('');\n"
            f"#5={style}('',(#7));\n#6={style}('',(#8));\n"
            f"#7=STYLED_ITEM('color',#{first});\n#8=STYLED_ITEM('color',#{second});\nENDSEC;\n"
        )

    assert canonical(text(3, 4), HEADER) == canonical(text(4, 3), HEADER)
    assert "#6=STYLED_ITEM('color',#2);" in canonical(text(4, 3), HEADER)
