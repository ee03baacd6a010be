"""Read LAS 2.0 and LAS 3.0 files; ``las_writing.py`` has the rules by which helibore writes them.

    header   ~Version  VERS, WRAP, DLM
             ~Well     STRT, STOP, STEP, NULL, WELL ...
             ~Curve    NAME.UNIT  value : description {AF8.3;10deg}       one line for each column of the rows
    rows     ~A (LAS 2),  ~Log_Data[1] | Log_Definition[1] (LAS 3)        one RawSet for each of these sections

lasio reads the header of LAS 2, because it knows many dialects. This file reads LAS 3, because lasio 0.32 supports
neither arrays nor sets, and reads comma-delimited rows as one column. ``number_rows`` reads the rows of both versions.
``helibore.channels.header_entries`` lists the mnemonics of company, well, field and other entries.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from helibore.base import units
from helibore.base.errors import needs
from helibore.base.limits import check_limit
from helibore.files.headings import is_number
from helibore.files.input_file import InputFile
from helibore.files.number_spellings import read_spellings
from helibore.files.raw_set import Channel, Loss, RawFile, RawSet, SectorAxis, readable_sets, unique
from helibore.files.row_lines import read_rows_without_notes
from helibore.files.text_layouts import text_rules

# MNEM.UNIT  VALUE : DESCRIPTION {FORMAT} | ASSOCIATION          (LAS 3.0 file structure, pages 8 to 10)
ITEM = re.compile(r"^\s*(?P<name>[^.:]*?|[^\s.:]+:\d+)\s*\.(?P<unit>\S*)(?P<rest>.*)$")
NUMBERED = re.compile(r"^(\s*[^\s.:]+)(:\d+)(\s*\..*:)")
"""A repeated name as helibore and lasio number it, ``P1AZ:1.DEG :``; lasio reads its colon as the end of the unit."""
DATA = re.compile(r"A[^_]*$|LOG_DATA|.*_DATA(\[\d+\])?$")
"""Kinds of the sections of LAS 3 that hold rows: ~A and ~ASCII, ~Log_Data, ~Core_Data[1] ..."""
FORMAT = re.compile(r"\{\s*(?P<format>[^{}]*)\}")
DATED = re.compile(r"(?:[DMY]{1,4}[/.-]){2}[DMY]{2,4}(?P<date>\d\S*)", re.IGNORECASE)
"""A date that follows its format without a blank, where the unit should stand: ``DATE.DD/MM/YYYY21/05/2007``."""
FEET_IN_METRE = 1.0 / units.factor("ft", units.LENGTH)
INDEX = ("STRT", "STOP", "STEP", "NULL")
"""Header items that are kept without their unit: the range of the index, and the null value of the rows."""

# One angle of an array member: {AF10.4;0deg} or {AF10.4; 2.5 deg}.
SPACING = re.compile(r"^\s*(?P<value>[+-]?[\d.]+(?:[eE][+-]?\d+)?)\s*(?P<unit>\S*)\s*$")

EACH_LINE = re.compile("^.*", re.MULTILINE)


@dataclass
class LasSection:
    """One section: its title without the tilde, the number of the title's line, and the text below it."""

    title: str
    line: int
    text: str = ""

    @property
    def lines(self) -> Iterator[str]:
        """The lines below the title, cut from the text one by one."""
        return (line[0] for line in EACH_LINE.finditer(self.text))

    @property
    def kind(self) -> str:
        """The title up to the first blank or bar, in upper case: ``LOG_DATA[1]``."""
        return re.split(r"[\s|]", self.title.strip(), maxsplit=1)[0].upper()


@dataclass
class LasCurve:
    """A column of the rows, as one line of a ~Curve or definition section states it."""

    name: str
    unit: str
    description: str
    axis: SectorAxis | None = None


def read(source: InputFile) -> RawFile:
    """Open a LAS file of version 2 or 3; version 1.2 is read as version 2, with a remark."""
    text, remark = source.text()
    sections = find_sections(source, text)
    remarks = [remark] if remark else []
    version = {"VERS": "2.0"}
    if any(section.kind.startswith("V") for section in sections):
        version = _items(_section(source, sections, "V"))
    else:
        remarks.append("no ~Version section: read as LAS 2.0")
    number = version.setdefault("VERS", "").strip()
    if not number:
        remarks.append("~Version states no VERS: read as LAS 2.0")
        number = version["VERS"] = "2.0"
    major = int(float(number)) if is_number(number) and float(number) < 4 else 0
    if major not in (1, 2, 3):
        raise source.error("must be 2.0 or 3.0", f"line {sections[0].line}: VERS", value=repr(number))
    if major == 1:
        remarks.append("LAS 1.2: read as LAS 2.0; value and description are swapped in its ~Well section")
    read_sets = _las3 if major == 3 else _las2
    return RawFile(f"LAS {number}", read_sets(source, sections, version, remarks))


def find_sections(source: InputFile, text: str) -> list[LasSection]:
    """Split the text at the lines that start with ~, or with blanks, ~ and a letter.

    Comments are kept, because errors name line numbers.
    """
    heads: list[tuple[int, int]] = []  # where the line of each title begins and ends
    end = 0
    while (at := text.find("~", end)) >= 0:
        start, end = text.rfind("\n", 0, at) + 1, (text.find("\n", at) + 1 or len(text) + 1) - 1
        if _is_head(text[start:end]):
            heads.append((start, end))
    sections: list[LasSection] = []
    line, counted = 1, 0
    for (start, end), after in zip(heads, [*(start for start, _ in heads[1:]), len(text) + 1], strict=True):
        line, counted = line + text.count("\n", counted, start), start
        sections.append(LasSection(text[start:end].strip()[1:], line, text[end + 1 : after - 1]))
    if sections and sections[-1].title[:1].isspace() and not any(DATA.match(section.kind) for section in sections):
        sections[-1].title = f"A{sections[-1].title}"  # "~  DEPT  GR" above the rows
    if len(sections) < 2 and not (sections and sections[0].kind == "A"):
        raise source.error("truncated: one section of the header and no other", sections[0].line if sections else 1)
    return sections


def _is_head(line: str) -> bool:
    return line.startswith("~") or (line.lstrip().startswith("~") and line.lstrip()[1:2].isalpha())


def _section(source: InputFile, sections: list[LasSection], letter: str) -> LasSection:
    for section in sections:
        if section.kind.startswith(letter):
            return section
    name = {"V": "Version", "W": "Well", "C": "Curve", "A": "A(scii)"}[letter]
    raise source.error(f"truncated or damaged: no ~{name} section")


def _items(section: LasSection, units: bool = False) -> dict[str, str]:
    """Return the values of a header section by mnemonic, from lines of the form MNEM.UNIT VALUE : DESCRIPTION.

    With ``units``, a value that is a number is followed by its unit.
    """
    values: dict[str, str] = {}
    for line in section.lines:
        match = ITEM.match(line)
        if match and not line.lstrip().startswith("#"):
            value, colon, after = match["rest"].rpartition(":")
            text = (value if colon else after).strip()
            values.setdefault(match["name"].upper(), _with_unit(match["unit"] if units else "", text))
    return values


def _las2(source: InputFile, sections: list[LasSection], version: dict[str, str], remarks: list[str]) -> list[RawSet]:
    """Return the one set of a LAS 2 file. lasio reads the header, and ``number_rows`` reads the rows."""
    data = _section(source, sections, "A")
    if data is not sections[-1]:
        last = sections[-1]
        what = f"line {last.line}: ~{last.kind} follows the data section; its lines are not rows"
        remarks.append(Loss(what) if last.kind.startswith("A") else what)
    header = [section for section in sections if section is not data]
    curves, params, items = (_lasio_items(source, header, letter, version, remarks) for letter in "CPW")
    curves = [LasCurve(c.original_mnemonic.strip(), _unit_and_value(c)[0], *_described(c.descr or "")) for c in curves]
    if not curves:
        curves = _curves_of_title(source, sections, data, remarks)
    curves = _curves_with_cells(source, data, curves, version, remarks)
    _name_curves(curves, remarks)
    _skip_names(data, curves, remarks)
    wrapped = version.get("WRAP", "NO").upper().startswith("Y")
    named = [
        (name, *_unit_and_value(item))
        for of in (params, items)
        for name, item in zip(_unique_names(of), of, strict=True)
    ]
    units_of, well = ({name: each[part] for name, *each in named[len(params) :]} for part in (0, 1))
    stated = {name: _with_unit(unit, value) for name, unit, value in named}
    log_set = _set(source, "log", data, curves, None, well, remarks, wrapped)
    _check_range(log_set, well, units_of)
    log_set.header = stated | {name: well[name] for name in INDEX if name in well}
    return [log_set]


def _curves_of_title(
    source: InputFile, sections: list[LasSection], data: LasSection, remarks: list[str]
) -> list[LasCurve]:
    """Return the curves that the title of the data section names (``~A DEPT C1 C2``), for a file without ~Curve.

    The unit of the index is that of STRT; other units are unknown.
    """
    names = data.title.split()[1:]
    if not names:
        curves = [section for section in sections if section.kind.startswith("C")]
        place = f"line {curves[0].line}" if curves else None
        raise source.error(
            "the ~Curve section defines no curve" if curves else "truncated or damaged: no ~Curve section", place
        )
    well = [section for section in sections if section.kind.startswith("W")]
    strt = [ITEM.match(line) for section in well for line in section.lines]
    units_of_index = [match["unit"] for match in strt if match and match["name"].strip().upper() == "STRT"]
    remarks.append("no ~Curve section: the names stand after ~A, and only the index has a unit, that of STRT")
    return [LasCurve(name, "" if at else "".join(units_of_index[:1]), "") for at, name in enumerate(names)]


def _curves_with_cells(
    source: InputFile, data: LasSection, curves: list[LasCurve], version: dict[str, str], remarks: list[str]
) -> list[LasCurve]:
    """Return one curve for each cell of the first row, if ~Curve defines more or fewer of them.

    They are the curves that ~A names. If it names none, only a salvage goes on: the last curves have no cells, or the
    last cells have no curve.
    """
    rows = (line.split() for line in data.lines if line.strip() and not line.lstrip().startswith("#"))
    cells = next(rows, [])
    named = [name.upper() for name in data.title.split()[1:]]
    by_name = {curve.name.upper(): curve for curve in reversed(curves)}
    if len(cells) == len(named) < len(curves) and set(named) <= set(by_name):
        without = ", ".join(curve.name for curve in curves if curve.name.upper() not in named)
        remarks.append(f"the rows have the {len(named)} columns named after ~A; ~Curve also defines {without}")
        return [by_name[name] for name in named]
    if len(cells) == len(named) > len(curves) and set(by_name) <= set(named) and len(set(named)) == len(named):
        added = ", ".join(name for name in named if name not in by_name)
        remarks.append(f"the rows have the {len(named)} columns named after ~A; ~Curve does not define {added}")
        return [by_name.get(name, LasCurve(name, "", "")) for name in named]
    plain = source.options.salvage and not version.get("WRAP", "NO").upper().startswith("Y")
    count = len(cells)
    if not plain or count in (0, 1, len(curves)) or {len(row) for row in rows} - {count}:
        return curves
    if count < len(curves):
        without = ", ".join(curve.name for curve in curves[count:])
        remarks.append(Loss(f"salvaged: the rows have {count} columns of {len(curves)} curves: {without} has none"))
        return curves[:count]
    remarks.append(Loss(f"salvaged: ~Curve defines {len(curves)} of {count} columns: the last are called by number"))
    return [*curves, *(LasCurve(f"column {number}", "", "") for number in range(len(curves) + 1, count + 1))]


def _skip_names(data: LasSection, curves: list[LasCurve], remarks: list[str]) -> None:
    """Make a comment of the first row, and of the second, if they repeat the names and the units of the curves."""
    lines = enumerate(EACH_LINE.finditer(data.text), data.line + 1)
    rows = ((number, line) for number, line in lines if line[0].strip() and not line[0].lstrip().startswith("#"))
    header = [c.name for c in curves], [c.unit for c in curves if c.unit]
    for (number, line), stated in zip(rows, header, strict=False):
        cells = [cell.strip('"[]()').upper() for cell in re.split(r"[\s,;]+", line[0].strip())]
        if cells != [each.upper() for each in stated]:
            return
        start = line.start() + len(data.text) - len(line.string)
        data.text = f"{data.text[:start]}# {data.text[start:]}"
        remarks.append(f"line {number} repeats the header: it is no row")


def _name_curves(curves: list[LasCurve], remarks: list[str]) -> None:
    """Name the curves that have no name, and number the curves that share a name."""
    for number, curve in enumerate(curves, 1):
        if not curve.name:
            curve.name = f"column {number}"
            remarks.append(f"curve {number} has no name: it is called {curve.name}")
    for curve, name in zip(curves, unique([curve.name for curve in curves]), strict=True):
        curve.name = name


def _lasio_items(
    source: InputFile, sections: list[LasSection], letter: str, version: dict[str, str], remarks: list[str]
) -> list[Any]:
    """Return the items of the last section of a letter, as lasio reads its lines; none without such a section.

    A line that is no item is left out, with a remark; in ~Well it is an error. A curve that is lost so is found by the
    count of the cells.

    lasio reads line by line here, because the time that its reader of files takes grows with the cube of the number of
    items that share a name: 40 s for 500.
    """
    with needs("lasio", "las"):
        import lasio
    section = next((one for one in reversed(sections) if one.kind.startswith(letter) and "_" not in one.kind), None)
    if section is None:
        return []
    lines = enumerate(section.lines, section.line + 1)
    filled = [(number, line) for number, line in lines if line.strip() and not line.lstrip().startswith("#")]
    check_limit(f"{source.path.name}, line {section.line}: ~{section.kind}", "columns", len(filled))
    items = []
    parser = lasio.reader.SectionParser(f"~{section.title}", version=1.2 if float(version["VERS"]) < 2 else 2.0)
    for number, line in filled:
        try:
            numbered = NUMBERED.match(line) if letter == "C" else None
            plain = NUMBERED.sub(r"\1\3", line) if numbered else line
            parts = lasio.reader.read_header_line(plain.strip(), section_name=parser.section_name2)
            items.append(parser(**parts | {"name": parts["name"].upper() + (numbered[2] if numbered else "")}))
        except Exception as error:  # lasio has no error class of its own: KeyError, AttributeError, IndexError ...
            rule = f"the header is damaged: {line.strip()[:40]!r} is no item of ~{section.kind}"
            if letter == "W":
                raise source.error(rule, number) from error
            remarks.append(Loss(f"line {number}: {rule}; it is left out"))
    return items


def _unique_names(items: list[Any]) -> list[str]:
    return unique([item.useful_mnemonic for item in items])


def _unit_and_value(item: Any) -> tuple[str, str]:
    """Return unit and value of a header line. Some files have a blank in the unit: ``STRT.0.1 in 1023720``."""
    unit, value = item.unit or "", str(item.value)
    first, _, rest = value.partition(" ")
    if re.fullmatch(r"[\d./]+", unit) and units.measures(f"{unit} {first}"):
        return f"{unit} {first}", rest.strip()
    return unit, value


def _with_unit(unit: str, value: str) -> str:
    date = None if value else DATED.fullmatch(unit)
    if date:
        return date["date"]
    return f"{value} {unit}" if unit and is_number(value) else value


def _null(text: str | None) -> tuple[float, ...]:
    """Return a header's number, which may have a decimal comma; nothing for other text."""
    try:
        return (float(text.replace(",", ".")),) if text else ()
    except ValueError:
        return ()


def _las3(source: InputFile, sections: list[LasSection], version: dict[str, str], remarks: list[str]) -> list[RawSet]:
    """Return one set for each data section of a LAS 3 file that can be read."""
    well = _items(_section(source, sections, "W"))
    stated: dict[str, str] = {}
    for section in sections:
        if section.kind.startswith("W") or "PARAMETER" in section.kind:
            stated |= _items(section, units=True)
    stated |= {name: well[name] for name in INDEX if name in well}
    delimiter = {"": None, "SPACE": None, "COMMA": ",", "TAB": "\t"}.get(version.get("DLM", "").upper(), "?")
    if delimiter == "?":
        place = f"line {sections[0].line}: DLM"
        raise source.error("must be SPACE, COMMA or TAB", place, value=repr(version["DLM"]))
    titles = {section.kind for section in sections}
    tables = [
        section for section in sections
        if DATA.match(section.kind) or section.title.partition("|")[2].strip().upper() in titles
    ]  # fmt: skip
    if not tables:
        raise source.error("truncated: no data section (~Log_Data or ~ASCII)", sections[-1].line)

    def read_table(section: LasSection) -> RawSet:
        own_remarks = list(remarks)
        curves = _curves(source, _definition(source, sections, section), own_remarks)
        return _set(source, section.kind.title(), section, curves, delimiter, dict(stated), own_remarks)

    return readable_sets(partial(read_table, section) for section in tables)


def _definition(source: InputFile, sections: list[LasSection], data: LasSection) -> LasSection:
    """Return the section that defines the columns of ``data``.

    The title of ``data`` may name this section after ``|``. If it names none, LOG_DEFINITION[1] defines LOG_DATA[1];
    without such a section, ~Curve or ~Log_Definition defines the columns.
    """
    named = data.title.partition("|")[2].strip().upper()
    stem = data.kind.replace("_DATA", "_DEFINITION")
    wanted = [named] if named else [*([stem] if stem != data.kind else []), "CURVE", "LOG_DEFINITION"]
    for title in wanted:
        for section in sections:
            if section.kind == title or (title == "CURVE" and section.kind.startswith("C") and "_" not in section.kind):
                return section
    raise source.error(f"~{data.kind}: no section ~{wanted[0].title()} defines its columns", data.line)


def _curves(source: InputFile, section: LasSection, remarks: list[str]) -> list[LasCurve]:
    """Return the columns that a definition section defines.

    The members of an array are columns named ``NAME[1]``, ``NAME[2]`` ..., each with its angle if the file states it.
    """
    curves: list[LasCurve] = []
    for number, line in enumerate(section.lines, section.line + 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        match = ITEM.match(line)
        if not match:
            raise source.error(f"{line.strip()[:40]!r}: must read NAME.UNIT : DESCRIPTION", number)
        form = FORMAT.search(match["rest"])
        described = FORMAT.sub("", match["rest"]).partition("|")[0].partition(":")[2]
        curves.append(LasCurve(match["name"], match["unit"], described, _axis(form["format"]) if form else None))
    if not curves:
        raise source.error(f"~{section.kind} defines no column", section.line)
    _name_curves(curves, remarks)
    return curves


def _described(text: str) -> tuple[str, SectorAxis | None]:
    """Return a description without its format, and the angle that the format of an array's member states."""
    form = FORMAT.search(text)
    axis = _axis(form["format"]) if form else None
    return (FORMAT.sub("", text), axis) if axis else (text, None)


def _axis(form: str) -> SectorAxis | None:
    """Return the angle in the format of an array member, such as ``AF10.4;0deg;10ft``, as an axis without a step.

    Return None if the format states no angle.
    """
    parts = form.split(";")
    if len(parts) < 2 or not parts[0].strip().upper().startswith("A"):
        return None
    spacing = SPACING.match(parts[1])
    return SectorAxis(float(spacing["value"]), None, spacing["unit"]) if spacing else None


def _set(
    source: InputFile, name: str, data: LasSection, curves: list[LasCurve], delimiter: str | None, well: dict[str, str],
    remarks: list[str], wrapped: bool = False,
) -> RawSet:  # fmt: skip
    """Read the rows of a data section into a set with one channel for each curve.

    ``well`` becomes the header of the set; its item NULL, if there is one, is the null value of the rows.
    """
    names = [curve.name for curve in curves]
    rows = read_rows_without_notes(
        source,
        data.text,
        data.line + 1,
        names,
        delimiter,
        text_rules(source.options.layouts),
        comments=True,
        wrapped=wrapped,
        salvage=source.options.salvage,
    )
    columns, units_of_texts, spellings = read_spellings(rows.columns, names, delimiter == ",", source.options.decimal)
    nulls = source.nulls + _null(well.get("NULL"))
    channels = [
        Channel(curve.name, curve.unit or units_of_texts.get(at, ""), curve.description, column, nulls, curve.axis)
        for at, (curve, column) in enumerate(zip(curves, columns, strict=True))
    ]
    remarks = [*remarks, *rows.remarks, *spellings]
    return RawSet(source.path, name, channels, rows.count, names[0], well, remarks, rows.line_of)


def _check_range(log_set: RawSet, well: dict[str, str], units_of: dict[str, str]) -> None:
    """Add a remark for each difference between STRT or STOP of the header and the first or last row.

    If STRT and the index have different units, one of them unknown, a remark says so. An index of text is skipped.
    """
    index = log_set[str(log_set.index)]
    if index.is_text:
        return
    unit = units_of.get("STRT") or ""
    try:  # STRT may be 10237.2 in units of 0.1 in, the rows 85.31 ft
        scale = units.factor(unit, units.LENGTH) / units.factor(index.unit, units.LENGTH)
    except ValueError:
        scale = 1.0
        if unit and index.unit and unit.lower() != index.unit.lower():
            log_set.remarks.append(f"STRT is in {unit}, the index {index.name} in {index.unit}")
    ratios: list[float] = []
    for name, row in (("STRT", 0), ("STOP", -1)):
        declared = _null(well.get(name))
        found = float(index.values[row])
        if declared and declared[0]:
            ratios.append(found / (scale * declared[0]))
        if declared and not np.isclose(scale * declared[0], found, rtol=0, atol=1e-3 * max(1.0, abs(found) * 1e-3)):
            log_set.remarks.append(
                f"{name} = {declared[0]:g} in the header, {found:g} in the rows: truncated or edited?"
            )
    metres = {"M": FEET_IN_METRE, "FT": 1.0 / FEET_IN_METRE, "F": 1.0 / FEET_IN_METRE}.get(index.unit.upper())
    if metres and len(ratios) == 2 and np.allclose(ratios, metres, rtol=1e-3):
        other = "feet" if index.unit.upper() == "M" else "metres"
        log_set.remarks.append(
            f"the rows are {ratios[0]:.4f} times STRT and STOP: {index.name} is in {other} although the header says "
            f"{index.unit}? It is read as {index.unit}; state its unit if that is wrong ({index.name}:{other[0]}"
            f"{'t' if other == 'feet' else ''})"
        )
