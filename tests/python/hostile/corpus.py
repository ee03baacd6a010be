"""Write the corpus of hostile files: a hundred small files, each at most 1 MB, that ask for much or lie.

    python tests/python/hostile/corpus.py FOLDER

The name of a file says by its start what opens it (see `open_all`): ``wall-``, ``picks-``, ``manifest-``, ``live-``,
``settings-``, ``journal-``, ``checkpoint-``; every other file is opened as a log.

Bombs unpack to a little more than the limit in force, which HELIBORE_LIMIT_UNPACKED changes.
"""

# lines of files

from __future__ import annotations

import gzip
import io
import json
import struct
import sys
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from helibore.base.limits import LIMITS, limit

ESC = "\x1b]0;OWNED\x07\x1b[31m"
LAS = "~V\nVERS. 2.0:\nWRAP. NO:\n~W\nSTRT.M 1:\nSTOP.M 2:\nSTEP.M 1:\nNULL. -999.25:\n~C\n"
LAS3 = LAS.replace("2.0", "3.0").replace("~W", "DLM. COMMA:\n~W")
SHEET = (
    '<worksheet xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"><sheetData>{}</sheetData></worksheet>'
)
HUGE = 10**12


def share(count: int) -> int:
    """How often a part of a long file is repeated: a third as often if the limit of bombs is lowered, as in CI."""
    return count if limit("unpacked") >= LIMITS["unpacked"] else count // 3


def zipped(members: dict[str, bytes], method: int = zipfile.ZIP_DEFLATED) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", method) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return stream.getvalue()


def npy(shape: tuple[int, ...], dtype: str = "<f8", content: bytes = b"", header: str = "") -> bytes:
    text = header or f"{{'descr': '{dtype}', 'fortran_order': False, 'shape': {shape}}}"
    return b"\x93NUMPY\x01\0" + struct.pack("<H", len(text) + 1) + text.encode() + b"\n" + content


def lying(content: bytes, what: int, size: int) -> bytes:
    """A zip archive whose directory states another size for every member; ``what`` is 20 (packed) or 24 (unpacked)."""
    changed = bytearray(content)
    at = -1
    while (at := changed.find(b"PK\x01\x02", at + 1)) >= 0:
        changed[at + what : at + what + 4] = struct.pack("<I", size)
    return bytes(changed)


def overlapping(name: str, content: bytes, times: int) -> bytes:
    """A zip archive whose directory names one member many times (the bomb of D. Fifield)."""
    one = zipped({name.format(0): content})
    start = one.index(b"PK\x01\x02")
    stop = one.index(b"PK\x05\x06")
    entry = one[start:stop]
    old = name.format(0).encode()
    entries = b"".join(entry.replace(old, name.format(n).encode().ljust(len(old), b"_")) for n in range(times))
    end = struct.pack("<4s4H2IH", b"PK\x05\x06", 0, 0, times, times, len(entries), start, 0)
    return one[:start] + entries + end


def workbook(*sheets: str, names: int = 1, shared: str = "") -> bytes:
    """A workbook whose sheets hold this XML; with ``names``, so many names of the first sheet."""
    count = max(len(sheets), names)
    listed = "".join(
        f'<sheet name="S{n}" sheetId="{n + 1}" r:id="r{n if len(sheets) > n else 0}"/>' for n in range(count)
    )
    office = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
    targets = "".join(
        f'<Relationship Id="r{n}" Type="{office}/worksheet" Target="worksheets/sheet{n + 1}.xml"/>'
        for n in range(len(sheets))
    )
    package = "http://schemas.openxmlformats.org/package/2006/relationships"
    if shared:
        targets += f'<Relationship Id="s" Type="{office}/sharedStrings" Target="sharedStrings.xml"/>'
    main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
    members = {
        "[Content_Types].xml": b"<Types/>",
        "_rels/.rels": f'<Relationships xmlns="{package}"><Relationship Id="a" Type="{office}/officeDocument" '
        f'Target="xl/workbook.xml"/></Relationships>'.encode(),
        "xl/workbook.xml": f'<workbook xmlns="{main}" xmlns:r="{office}"><sheets>{listed}</sheets></workbook>'.encode(),
        "xl/_rels/workbook.xml.rels": f'<Relationships xmlns="{package}">{targets}</Relationships>'.encode(),
        **{f"xl/worksheets/sheet{n + 1}.xml": SHEET.format(rows).encode() for n, rows in enumerate(sheets)},
    }
    if shared:
        members["xl/sharedStrings.xml"] = f'<sst xmlns="{main}"><si><t>{shared}</t></si></sst>'.encode()
    return zipped(members)


def dense_parquet(rows: int, length: int) -> bytes:
    """A table whose rows are lists of one value, which its pages state only once."""
    import pyarrow as pa
    from pyarrow import parquet

    values = pa.array(np.zeros(rows * length))
    lists = pa.FixedSizeListArray.from_arrays(values, length) if length > 1 else values
    stream = io.BytesIO()
    parquet.write_table(pa.table({"depth": lists}), stream, compression="zstd", row_group_size=rows)
    return stream.getvalue()


def texts() -> Iterator[tuple[str, str]]:
    """Tables, LAS, JSON and XML, as text."""
    one = "DEPT.M:\nGR.API:\n~A\n1 2\n2 3\n"
    yield "equal5000.las", LAS + "DEPT.M:\n" + "GR.API:\n" * 4999 + "~A\n" + "1 " * 5000 + "\n"
    yield "equal60000.las", LAS + "G.A:\n" * 60000 + "~A\n1\n"
    yield "params.las", LAS + one.replace("~A", "~P\n" + "BS.IN 8:x\n" * 50000 + "~A")
    yield "sections.las", LAS + "~C\n" * share(50000) + one
    yield "escape.las", LAS + f"DEPT.M:\n{ESC}GR.{ESC}:{ESC}\n~A\n1 2\n2 3\n"
    yield "version.las", LAS.replace("2.0", "9" * 10000) + one
    yield "null.las", LAS.replace("-999.25", "1e999") + one
    yield "nocolon.las", LAS + "~" + "x." * 200000
    yield "dots.las", LAS + "." * 300000 + "\n~A\n1\n"
    yield "blanks.las", LAS + one + " " * 900000
    yield "ones.las", LAS + "DEPT.M:\n~A\n" + "1\n" * 400000
    yield "wrapped.las", LAS.replace("NO", "YES") + "A.:\n" * share(20000) + "~A\n" + "1\n" * share(30000)
    yield "ragged.las", LAS + "A.:\n" * 3000 + "~A\n" + "1 2 3\n" * share(18000)
    yield "array.las", LAS3 + "".join(f"A[{n}].M : {{AF8.3;{n}deg}}\n" for n in range(25000)) + "~A\n1\n"
    yield "format.las", LAS3 + "DEPT.M : {" + "{" * 200000 + "\n~A\n1\n"
    yield "delimiter.las", LAS3.replace("COMMA", "x" * 100000) + one
    yield "data3.las", LAS3 + one + "~Log_Data[1] | Log_Data[1]\n1,2\n" * share(5000)
    yield "columns.csv", ",".join(f"c{n}" for n in range(40000)) + "\n" + ",".join("1" * 40000) + "\n"
    yield (
        "named.csv",
        ",".join(f"{n:x}radius{n:o}" for n in range(share(3000))) + "\n" + ",".join("1" * share(3000)) + "\n",
    )
    yield "equal.csv", "a," * 200000 + "a\n" + "1," * 200000 + "1\n"
    yield "image.csv", "depth_m," + ",".join(["img"] * 5000) + "\n" + ",".join("1" * 5001) + "\n"
    yield "escape.csv", f"depth_m,{ESC}rb({ESC})\n1,{ESC}\n2,x\n"
    yield "formula.csv", "depth_m,\"=cmd|' /C calc'!A0\"\n1,2\n2,3\n"
    yield "quote.csv", 'a,b\n1,"' + "2\n" * 300000
    yield "quotes.csv", "a,b\n" + '"' * 900001
    yield "line.csv", "a,b\n1," + "9" * 990000
    yield "digits.csv", "a,b\n" + ("1" * 400 + ",2\n") * 2000
    yield "exponent.csv", "a,b\n" + "1e999999999,-1e-99999999\n" * 20000
    yield "mixed.csv", "a;b,c\td|e\n" + "1;2,3\t4|5\n" * 10000
    yield "comments.csv", "#" + "# x: =1+1\n" * 80000
    yield "sep.csv", "sep=,\n" * 20000
    yield "decimal.csv", "a;b\n" + "1.234.567,8;1'2'3,4\n" * 10000
    yield "angles.csv", "azimuth,md\n" + "N45°59'59.9999999\"E,1\n" * 30000
    yield "blank.csv", "a b c\n" + "1   2      3\n" * 60000
    yield "unicode.csv", "a,b\n" + "１,٢\n" * 5000
    yield "spread.csv", "\n" * 900000
    yield "deep.json", "[" * 500000
    yield "deepobject.json", '{"a":' * 150000
    yield "integer.json", "[" + "9" * 500000 + "]"
    curve = '{"name": "A", "valueType": "float", "dimensions": %s}'
    yield "dimensions.json", '[{"header": {}, "curves": [' + curve % HUGE + '], "data": [[null]]}]'
    yield (
        "empties.json",
        '[{"header": {}, "curves": [' + curve % 10**6 + '], "data": [' + "[null]," * 90000 + "[null]]}]",
    )
    yield "curves.json", json.dumps([{"header": {}, "curves": [{"name": "A"}] * 30000, "data": [[1] * 30000]}])
    yield "logs.json", "[" + ",".join(['{"header":{},"curves":[{"name":"A"}],"data":[[1]]}'] * share(3000)) + "]"
    yield "escape.json", json.dumps([{"header": {"name": ESC}, "curves": [{"name": ESC, "unit": ESC}], "data": [[1]]}])
    yield "nan.json", '[{"header":{},"curves":[{"name":"A"}],"data":[[NaN],[Infinity],[1e999]]}]'
    yield "wells.json", json.dumps({"wells": {ESC: {"MD": [{}]}, "a": 5, "b": {"header": []}}})
    laughs = "".join(f'<!ENTITY l{n} "{f"&l{n - 1};" * 10}">' for n in range(1, 20))
    yield "laughs.xml", f'<!DOCTYPE logs [<!ENTITY l0 "ha">{laughs}]><logs>&l19;</logs>'
    yield "entity.xml", '<!DOCTYPE logs [<!ENTITY x SYSTEM "file:///etc/passwd">]><logs>&x;</logs>'
    yield "parameter.xml", '<!DOCTYPE logs [<!ENTITY % x SYSTEM "http://127.0.0.1:9/x"> %x;]><logs/>'
    yield "quadratic.xml", '<logs><!DOCTYPE x [<!ENTITY a "' + "a" * 100000 + '">]>' + "&a;" * 10000 + "</logs>"
    yield "deep.xml", "<logs>" * 100000
    yield "attributes.xml", "<logs " + " ".join(f'a{n}="1"' for n in range(60000)) + "/>"
    yield "equalattributes.xml", "<logs " + 'a="1" ' * 90000 + "/>"
    yield "names.xml", "<logs><log>" + "".join(f"<n{n}/>" for n in range(15000)) + "</log></logs>"
    yield "children.xml", "<logs><log><logCurveInfo>" + "<a/>" * 150000
    yield "manylogs.xml", "<logs>" + "<log><name>x</name></log>" * share(8000) + "</logs>"
    rows = "<data>" + "1," * 20 + "</data>"
    yield (
        "mnemonics.xml",
        f"<logs><log><logData><mnemonicList>{'A,' * 200000}A</mnemonicList>{rows}</logData></log></logs>",
    )
    yield "escape.xml", "<logs><log><name>&#27;]0;OWNED&#7;</name></log></logs>"
    yield "namespace.xml", "<logs " + "".join(f'xmlns:a{n}="u{n}" ' for n in range(20000)) + "/>"
    yield "wits.txt", "&&\n0108" + "9" * 900000 + "\n!!\n"
    yield "witsframes.txt", "&&\n!!\n" * 150000
    table = "class,depth_m,toolface_deg,apparent_dip_deg,note\n"
    yield "picks-formula.csv", table + "bed,1,2,3,=cmd|x\n"
    yield "picks-long.csv", table + "bed,1,2,3," + "x" * 900000
    yield "picks-numbers.csv", table + "bed,1e999,nan,-inf,\n"
    yield "picks-columns.csv", table[:-1] + ",a" * 200000 + "\nbed,1,2,3,\n"


def tomls() -> Iterator[tuple[str, str]]:
    """Manifests, settings of runs, and configurations of ``live``."""
    well = '[[well]]\nname = "A"\n'
    for kind in ("manifest", "settings", "live"):
        yield f"{kind}-deep.toml", "a = " + "[" * 100000
        yield f"{kind}-tables.toml", "".join(f"[{'a.' * 20}b{n}]\n" for n in range(share(1500)))
        yield f"{kind}-keys.toml", "".join(f"k{n} = 1\n" for n in range(share(10000)))
        yield f"{kind}-dots.toml", "a." * 20000 + "b = 1\n"
        yield f"{kind}-integer.toml", "a = " + "9" * 500000
        yield f"{kind}-escape.toml", f"{json.dumps(ESC)} = 1\n"
    for number, address in enumerate(
        ("zip://a.las::https://h/b.zip", "reference://x", "filecache::s3://b/x.las", "simplecache::file:///etc/passwd")
    ):
        yield (
            f"manifest-chain{number}.toml",
            f'output = "{address}"\n{well}caliper = "{address}"\nwall.bit_diameter = 0.2\n',
        )
    yield "manifest-catalogue.toml", 'output = "o"\ncatalogue = "reference://x.parquet"\n'
    yield (
        "manifest-key.toml",
        f'output = "o"\n{well}caliper = "nope://h/a.las?X-Amz-Signature=S3CRETS"\nwall.bit_diameter = 0.2\n',
    )
    yield "manifest-wells.toml", 'output = "o"\n' + well * share(5000)
    yield (
        "manifest-sectors.toml",
        f'output = "o"\n{well}caliper = "a.csv"\nwall.sectors = {HUGE}\nwall.bit_diameter = 1\n',
    )


def binaries() -> Iterator[tuple[str, bytes]]:
    """Archives, arrays, workbooks and other binary formats."""
    array = npy((2,), content=bytes(16))
    zeros = bytes(1 << 20)
    over = limit("unpacked") * 17 // 16 & -8
    yield "shape.npz", zipped({"a.npy": npy((HUGE,)), "b.npy": array})
    yield "shapes.npz", zipped({"a.npy": npy((1 << 27, 3)), "b.npy": npy((1 << 26,))})
    yield "negative.npz", zipped({"a.npy": npy((-1, -5)), "b.npy": array})
    yield "dimensions.npz", zipped({"a.npy": npy((1,) * 60)})
    yield "object.npz", zipped({"a.npy": npy((1,), "|O", b"cos\nsystem\n(S'id'\ntR.")})
    yield "header.npz", zipped({"a.npy": npy((1,), header="(" * 60000)})
    yield "call.npz", zipped({"a.npy": npy((1,), header="__import__('os').system('id')")})
    yield "field.npz", zipped({"a.npy": npy((1,), "<f8', 'x': '" + "y" * 60000)})
    yield "wide.npz", zipped({"a.npy": npy((1 << 20,), "<U1000000"), "b.npy": array})
    yield "bomb.npz", zipped({"a.npy": npy((over >> 3,), content=bytes(over))})
    yield "lies.npz", lying(zipped({"a.npy": npy((over >> 3,), content=bytes(over))}), 20, 1 << 30)
    yield "overlap.npz", overlapping("{:06d}.npy", npy((2 << 17,), content=zeros * 2), 400)
    yield "members.npz", zipped({f"{n}.npy": b"" for n in range(share(9000))}, zipfile.ZIP_STORED)
    yield "escape.npz", zipped({f"{ESC}.npy": array})
    yield "a.npy", npy((HUGE,))
    row = '<row r="1"><c r="A1"><v>1</v></c></row>'
    yield "dense.xlsx", workbook('<row r="1048576"><c r="XFD1048576"><v>1</v></c></row>')
    yield "sheets.xlsx", workbook(row * 3, names=400)
    yield "loose.xlsx", workbook("<row>" + "<c><v>1</v></c>" * 16000 + "</row>" + "<row/>" * 20000)
    uses = "".join(f'<c r="A{n}" t="s"><v>0</v></c>' for n in range(1, 20001))
    yield "shared.xlsx", workbook(f"<row>{uses}</row>", shared="x" * 30000)
    yield "bomb.xlsx", workbook(row + " " * over)
    yield "laughs.xlsx", workbook('<!DOCTYPE a [<!ENTITY b "bbbbbbbbbb">]>' + "<row><c><v>&b;</v></c></row>" * 1000)
    yield "lies.xlsx", lying(workbook(row + " " * over), 24, 200)
    yield "members.xlsx", zipped({"xl/workbook.xml": b"<a/>"} | {f"x{n}": b"" for n in range(8000)})
    yield "escape.xlsx", workbook(row).replace(b"S0", b"\x1b[")
    yield "bomb.las.gz", gzip.compress((LAS + "DEPT.M:\n~A\n").encode() + b"1\n" * (over >> 1), 9)
    yield "lines.las.gz", gzip.compress((LAS + "DEPT.M:\n~A\n").encode() + b"12\n" * (over // 3), 9)
    yield "bomb.csv.gz", gzip.compress(b"a,b\n" + b"1,2\n" * (over >> 2), 9)
    yield "bomb.json.gz", gzip.compress(b'[{"a": "' + b" " * over, 9)
    yield "twice.csv.gz", gzip.compress(gzip.compress(b"a,b\n" + b"1,2\n" * (over >> 2)))
    yield "members.csv.gz", gzip.compress(b"") * share(40000)
    yield "cut.csv.gz", gzip.compress(np.random.default_rng(1).bytes(1000))[:-20]
    yield "bomb.zst", b"\x28\xb5\x2f\xfd" + zeros[:1000]
    yield "zeros.dlis", b"   1V1.00RECORD 8192Default Storage Set".ljust(80) + zeros[:500000]
    yield "lengths.dlis", b"   1V1.00RECORD 8192Default Storage Set".ljust(80) + b"\x00\x04\xff\x01" * 100000
    yield "cut.dlis", b"   1V1.00RECORD 8192Default".ljust(80) + b"\x20\x00\xff\x01\x00\x80\x80\x00"
    reel = bytes([0, 62, 0, 0, 132, 0])
    yield "zeros.lis", reel.ljust(62, b" ") + zeros[:500000]
    yield "lengths.lis", reel.ljust(62, b" ") + b"\xff\xff\x80\x00\x40\x00" * 80000
    yield "cut.parquet", b"PAR1" + zeros[:100] + b"PAR1"
    yield "dense.parquet", dense_parquet(over >> 3, 1)
    yield "lists.parquet", dense_parquet(1000, over // 8000)
    yield "length.parquet", b"PAR1" + struct.pack("<I", 0x7FFFFFFF) + b"PAR1"
    yield "footer.parquet", b"PAR1" + b"\x15\x02\x19\xfc\xff\xff\xff\xff\x0f" * 100 + struct.pack("<I", 900) + b"PAR1"
    yield "a.glb", b"glTF" + struct.pack("<2I", 2, 0xFFFFFFFF) + zeros[:100]
    yield "a.png", b"\x89PNG\r\n\x1a\n" + struct.pack(">I4s2I5BI", 13, b"IHDR", 1 << 30, 1 << 30, 8, 6, 0, 0, 0, 0)
    yield "a.svg", b"<svg xmlns='http://www.w3.org/2000/svg'><script>alert(1)</script></svg>"
    yield "a.pickle", b"cos\nsystem\n(S'echo OWNED'\ntR."
    contents = {"format": "helibore wall", "version": 1, "helibore": "1", "settings": {"sectors": HUGE}}
    text = json.dumps(contents).encode()
    yield "wall-sectors.wall", zipped({"helibore.json": text}, zipfile.ZIP_STORED)
    yield "wall-deep.wall", zipped({"helibore.json": b"[" * 300000}, zipfile.ZIP_STORED)
    yield "wall-version.wall", zipped({"helibore.json": text.replace(b": 1,", b": 1e999,")}, zipfile.ZIP_STORED)
    yield "wall-array.wall", zipped({"helibore.json": text, "samples/depth.npy": npy((HUGE,))}, zipfile.ZIP_STORED)
    yield "wall-bomb.wall", zipped({"helibore.json": b" " * over})
    yield "wall-pickle.wall", b"\x80\x05cos\nsystem\n(S'echo OWNED'\ntR."
    yield "wall-lies.wall", lying(zipped({"helibore.json": text}, zipfile.ZIP_STORED), 24, 1 << 30)
    yield "checkpoint-bomb.zip", zipped({"contents.json": b" " * over})
    yield "checkpoint-array.zip", zipped({"contents.json": b"{}", "0.npy": npy((HUGE,))}, zipfile.ZIP_STORED)
    yield "journal-zeros.hbj", b"HBJ" + zeros[:500000]
    yield "journal-random.hbj", np.random.default_rng(2).bytes(300000)
    yield "journal-bomb.hbj.gz", gzip.compress(bytes(over))
    yield "journal-packed.hbj", zlib.compress(zeros)


def write(folder: Path) -> list[str]:
    """Write all files; return their names."""
    names = []
    for name, content in (*texts(), *tomls(), *binaries()):
        found = content if isinstance(content, bytes) else content.encode()
        assert len(found) <= 1_000_000, (name, len(found))
        (folder / name).write_bytes(found)
        names.append(name)
    return names


if __name__ == "__main__":
    print("\n".join(write(Path(sys.argv[1]))))
