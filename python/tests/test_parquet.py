"""Tables of the command line as other software reads and writes them."""

from __future__ import annotations

import csv
import struct
from pathlib import Path
from typing import Any, Callable

import pytest

import piaffe

pyarrow = pytest.importorskip("pyarrow")

#: Two robots, one of which is none; at 4 m/s there is no motion.
ASKED = ["study", "trot", "--speed", "0.5,4.0", "--criterion", "torque", "--starts", "1", "--also", "certificate,slopes,stability"]

INTEGERS = {"point", "design", "starts", "successes", "optima"}
TEXTS = {"gait", "criterion", "status", "reason", "conflict", "least_limit", "active", "certificate"}


@pytest.fixture(scope="module")
def folder(program: Callable[..., str], tmp_path_factory: pytest.TempPathFactory) -> Path:
    out: Path = tmp_path_factory.mktemp("study")
    program(*ASKED, "--vary", "links.thigh.mass=-1,1.5", "--out", str(out))
    return out


def lines(folder: Path) -> list[dict[str, str]]:
    with (folder / "study.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def same(cell: str, value: Any) -> bool:
    """Whether a cell of the CSV is this value, to the bit; an empty one is none."""
    if cell == "" or value is None:
        return cell == "" and value is None
    if isinstance(value, float):
        return struct.pack("<d", float(cell)) == struct.pack("<d", value)
    return cell == str(value)


def test_pyarrow_reads_what_the_csv_has(folder: Path) -> None:
    from pyarrow import parquet

    table = parquet.read_table(folder / "study.parquet")
    rows = lines(folder)
    assert table.column_names == list(rows[0]) and table.num_rows == len(rows) == 4
    for field in table.schema:
        kind = pyarrow.int64() if field.name in INTEGERS else pyarrow.string() if field.name in TEXTS else pyarrow.float64()
        assert field.type == kind and field.nullable, field
    for row, other in zip(rows, table.to_pylist()):
        assert [name for name in row if not same(row[name], other[name])] == []
    assert table["cost"].null_count == 3 and table["reason"].null_count == 1
    assert table["status"].to_pylist() == ["no-robot", "no-robot", "optimal", "infeasible"]
    assert parquet.read_metadata(folder / "study.parquet").created_by == f"piaffe {piaffe.__version__}"


def test_pandas_reads_it(folder: Path) -> None:
    pandas = pytest.importorskip("pandas")
    table = pandas.read_parquet(folder / "study.parquet")
    assert table["cost"].isna().sum() == 3 and table["point"].tolist() == [0, 1, 2, 3]
    (best,) = table[table["status"] == "optimal"]["cost"]
    assert same(lines(folder)[2]["cost"], float(best))


def test_polars_reads_it(folder: Path) -> None:
    polars = pytest.importorskip("polars")
    table = polars.read_parquet(folder / "study.parquet")
    rows = lines(folder)
    assert table.columns == list(rows[0])
    assert {str(kind) for kind in table.dtypes} == {"Int64", "Float64", "String"}
    for row, other in zip(rows, table.to_dicts()):
        assert [name for name in row if not same(row[name], other[name])] == []


@pytest.mark.parametrize("compression", ["snappy", None])
def test_designs_of_pandas_and_pyarrow_are_those_of_csv(
    program: Callable[..., str], tmp_path: Path, compression: Any
) -> None:
    pandas = pytest.importorskip("pandas")
    from pyarrow import parquet

    # 0.1 + 0.2 has a digit that fewer would lose; an integer is a number too.
    designs = {"links.thigh.mass": [1.5, 1.3 + 0.1 + 0.2], "gravity": [10, 9]}
    pandas.DataFrame(designs).to_csv(tmp_path / "designs.csv", index=False)
    pandas.DataFrame(designs).to_parquet(tmp_path / "pandas.parquet", compression=compression)
    parquet.write_table(pyarrow.table(designs), tmp_path / "arrow.parquet", compression=compression or "none")
    tables = []
    for name in ("designs.csv", "pandas.parquet", "arrow.parquet"):
        out = tmp_path / name.replace(".", "-")
        asked = ["study", "trot", "--speed", "0.5", "--criterion", "torque", "--designs", str(tmp_path / name)]
        program(*asked, "--out", str(out))
        tables.append((out / "study.csv").read_bytes())
    assert tables[0] == tables[1] == tables[2] and tables[0].count(b"optimal") == 2


def test_what_cannot_be_read_is_told(failing: Callable[..., str], tmp_path: Path) -> None:
    from pyarrow import parquet

    table = pyarrow.table({"links.thigh.mass": [1.5, None], "gravty": [9.81, 9.81]})
    file = tmp_path / "designs.parquet"
    asked = ["study", "trot", "--speed", "0.5", "--designs", str(file), "--out", str(tmp_path / "study")]
    parquet.write_table(table, file)
    assert "row 1: there is no number for links.thigh.mass" in failing(*asked)
    parquet.write_table(table.slice(0, 1), file)
    assert "gravity" in failing(*asked)
    parquet.write_table(table, file, compression="zstd")
    assert "Snappy" in failing(*asked)
    file.write_bytes(file.read_bytes()[:100])
    assert "designs.parquet: it cannot be read" in failing(*asked)
