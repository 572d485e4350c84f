"""CSV of instruments: each layout as its maker documents it, and what is wrong told by line and column.

The files are made here after the documents named beside them (docs/instrument-files.md); none is a copy of anybody's.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.signals.instrument_csv import InstrumentTable, read_table
from app.errors import UsageError

NAN = float("nan")

# MSO1000Z/DS1000Z User Guide, "CSV": names with Start and Increment, then units, then a counter before the values
RIGOL_1000Z = """X,CH1,CH2,Start,Increment,
Sequence,Volt,Volt,-6.000000e-03,2.000000e-03,
0,1.20e-01,-4.00e-02,,
1,1.60e-01,,,
2,2.00e-01,4.00e-02,,
"""
# MSO5000 User Guide, "CSV": start and step stand in the names' line
RIGOL_5000 = """CH1V,CH2V,t0 =-1.000000e-03, tInc = 5.000000e-04,
0.5,1.5,,
0.6,1.6,,
0.7,1.7,,
"""
# DS1000E User's Guide, "CSV"
RIGOL_1000E = """X,CH1,CH2,
Second,Volt,Volt,
-1.0e-03,0.1,0.2,
0.0e+00,0.3,0.4,
"""
# Siglent, SDS1000X-E User Manual, "Save: CSV"
SIGLENT = """Record Length,Analog:3
Sample Interval,Analog:0.0000020000
Vertical Units,CH1:V,CH2:A
Vertical Scale,CH1:1.00,CH2:0.50
Horizontal Units,s
Model Number,SDS1104X-E
Serial Number,SDSMMEBX0R0000
Source,CH1,CH2
Second,Volt,Ampere
-0.0000020000, 0.12000, 1.5
0.0000000000, 0.16000, 1.6
0.0000020000, 0.20000, 1.7
"""
# Keysight, InfiniiVision 2000/3000 X-Series User's Guide, "CSV"; Programmer's Guide: 9.9E+37 is a hole
KEYSIGHT = """x-axis,1,2
second,Volt,Ampere
-5.000E-03,1.2E-01,+9.9E+37
-4.000E-03,1.3E-01,+2.0E+00
-3.000E-03,1.4E-01,+3.0E+00
"""
# Tektronix, MSO/DPO2000 and TBS1000 User Manual
TEKTRONIX = """Model,TBS1102B
Firmware Version,FV:v4.06
Point Format,Y
Horizontal Units,S
Horizontal Scale,0.001
Sample Interval,4e-06
Record Length,3
Probe Attenuation,1.0,1.0
Vertical Units,V,A
Label,,
TIME,CH1,CH2
-8e-06,0.02,1
-4e-06,0.04,2
0,0.06,3
"""
# Tektronix, TDS200/1000/2000 User Manual: what it is of stands beside the first rows
TEKTRONIX_SIDEWAYS = """Record Length,2.500000e+03,,  -0.00500000,  0.02000,
Sample Interval,2.000000e-06,,  -0.00499800,  0.04000,
Trigger Point,1.250000000000e+03,,  -0.00499600,  0.06000,
Source,CH2,,  -0.00499400,  0.08000,
Vertical Units,A,,  -0.00499200,  0.10000,
Horizontal Units,s,,  -0.00499000,  0.12000,
,,,  -0.00498800,  0.14000,
"""
# Teledyne LeCroy, WaveSurfer Operator's Manual, "ASCII"
LECROY = """LECROYWS422,12345,Waveform
Segments,1,SegmentSize,3
Segment,TrigTime,TimeSinceSegment1
#1,26-Nov-2026 20:00:00,0
Time,Ampl
-1e-06,0.1
0,0.2
1e-06,0.3
"""
GERMAN = "Zeit [ms];Strom [A];Weg / mm\r\n0,0;1,25;\r\n0,5;1,50;-3,5\r\n1,0;;-4,0\r\n"
OURS = "time_s,position.0,velocity.0\n0.0,1,2\n0.1,,3\n"


def same(table: InstrumentTable, names: str, units: str, times_s: list[float], columns: list[list[float]]) -> None:
    assert (" ".join(table.names), " ".join(unit or "-" for unit in table.units)) == (names, units)
    np.testing.assert_allclose(table.time_s, times_s, rtol=1e-12, atol=1e-15)
    np.testing.assert_array_equal(table.columns, columns)


@pytest.mark.parametrize(
    ("text", "names", "units", "times_s", "columns"),
    [
        (RIGOL_1000Z, "CH1 CH2", "V V", [-0.006, -0.004, -0.002], [[0.12, 0.16, 0.2], [-0.04, NAN, 0.04]]),
        (RIGOL_5000, "CH1 CH2", "V V", [-1e-3, -5e-4, 0], [[0.5, 0.6, 0.7], [1.5, 1.6, 1.7]]),
        (RIGOL_1000E, "CH1 CH2", "V V", [-1e-3, 0], [[0.1, 0.3], [0.2, 0.4]]),
        (SIGLENT, "CH1 CH2", "V A", [-2e-6, 0, 2e-6], [[0.12, 0.16, 0.2], [1.5, 1.6, 1.7]]),
        (KEYSIGHT, "CH1 CH2", "V A", [-5e-3, -4e-3, -3e-3], [[0.12, 0.13, 0.14], [NAN, 2, 3]]),
        (TEKTRONIX, "CH1 CH2", "V A", [-8e-6, -4e-6, 0], [[0.02, 0.04, 0.06], [1, 2, 3]]),
        (
            TEKTRONIX_SIDEWAYS,
            "CH2",
            "A",
            [-0.005 + 2e-6 * each for each in range(7)],
            [[0.02, 0.04, 0.06, 0.08, 0.1, 0.12, 0.14]],
        ),
        (LECROY, "Ampl", "-", [-1e-6, 0, 1e-6], [[0.1, 0.2, 0.3]]),
        (GERMAN, "Strom Weg", "A mm", [0, 5e-4, 1e-3], [[1.25, 1.5, NAN], [NAN, -3.5, -4]]),
        (OURS, "position.0 velocity.0", "- -", [0, 0.1], [[1, NAN], [2, 3]]),
        ("CH1 (mV),time (us)\n1,0\n2,10\n", "CH1", "mV", [0, 1e-5], [[1, 2]]),
        ("# a note\n# t [s],u [V]\n0,1\n1,2\n", "u", "V", [0, 1], [[1, 2]]),
        ("time (s),a (V),a (V)\n0,1,2\n1,2,3\n", "a a (2)", "V V", [0, 1], [[1, 2], [2, 3]]),
        ("0 1\n".replace(" ", "\t") + "1\t2\n", "column 2", "-", [0, 1], [[1, 2]]),
    ],
    ids=lambda value: value.splitlines()[0][:20] if isinstance(value, str) and "\n" in value else "",
)
def test_the_layouts_that_instruments_write(
    text: str, names: str, units: str, times_s: list[float], columns: list[list[float]]
) -> None:
    same(read_table(text.encode()), names, units, times_s, columns)
    same(read_table(text.encode("utf-16")), names, units, times_s, columns)


def test_what_was_assumed_and_who_made_it_is_told() -> None:
    assert read_table(SIGLENT.encode()).instrument == "SDS1104X-E"
    assert read_table(TEKTRONIX.encode()).instrument == "TBS1102B"
    assert read_table(GERMAN.encode()).notes == ()
    assert "taken as seconds" in read_table(b"0,1\n1,2\n").notes[0]
    assert read_table("time (\xb5s),U (V)\n0,1\n2,3\n".encode("cp1252")).time_s.tolist() == [0, 2e-6]


def test_times_of_too_few_digits_are_even() -> None:
    table = read_table(b"time (s),U (V)\n0.001,1\n0.001,2\n0.002,3\n0.002,4\n0.003,5\n")
    np.testing.assert_allclose(table.time_s, np.linspace(0.001, 0.003, 5))
    assert "too few digits" in table.notes[0]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "the file is empty"),
        ("hello\nworld\n", "none of the first 2 lines is a row of numbers"),
        ("time (s),U (V)\n0,1\n1,broken\n", "line 3, column 2: 'broken' is no number"),
        ("time (s),U (V)\n0,1\n\n1,2,3\n", "line 4: 3 columns, 2 in the lines before"),
        ("time (s),U (V)\n0,1\n\n,2\n", "line 4, column 1: no time"),
        ("time (s),U (V)\n0,1\n2,2\n1,3\n", "line 4, column 1: 1 s is before 2 s above it"),
        ("time (days),U (V)\n0,1\n1,2\n", "line 1, column 1: time is in 'days'"),
        ("time (s),U (V)\n1,1\n1,2\n", "all times are the same"),
        ("time (s),U (V)\n1,1\n", "two rows at least"),
        (",".join("abcdefghijklmnopqr") + "\n" + ",".join("1" * 18) + "\n", "line 2: 18 columns, at most 17"),
        (RIGOL_1000Z.replace("2.000000e-03", "soon"), "line 2, column 5: 'soon' is no number"),
        ("Zeit [s];U [V]\n0,0;1,0\n0,1;1,x\n", "line 3, column 2: '1,x' is no number"),
    ],
)
def test_what_is_wrong_is_told_by_line_and_column(text: str, told: str) -> None:
    with pytest.raises(UsageError) as caught:
        read_table(text.encode())
    assert told in str(caught.value)


@given(
    rows=st.lists(st.tuples(st.floats(-1e6, 1e6), st.none() | st.floats(-1e6, 1e6)), min_size=2, max_size=40).filter(
        lambda rows: any(value is not None for _, value in rows)
    ),
    start_s=st.floats(-10, 10),
    comma=st.booleans(),
    crlf=st.booleans(),
)
def test_what_is_written_is_what_is_read(
    rows: list[tuple[float, float | None]], start_s: float, comma: bool, crlf: bool
) -> None:
    """Every number to its last digit, every hole as a hole, in both manners of writing numbers."""
    times_s = [start_s + 0.25 * number for number in range(len(rows))]

    def cell(value: float | None) -> str:
        return "" if value is None else repr(value).replace(".", "," if comma else ".")

    lines = [("time (s)", "a (V)", "b (A)")]
    lines += [(cell(at_s), cell(one), cell(two)) for at_s, (one, two) in zip(times_s, rows, strict=True)]
    text = ("\r\n" if crlf else "\n").join((";" if comma else ",").join(line) for line in lines)
    table = read_table(text.encode())
    assert table.time_s.tolist() == times_s
    np.testing.assert_array_equal(
        table.columns, [[one for one, _ in rows], [NAN if two is None else two for _, two in rows]]
    )


@given(st.binary(max_size=300) | st.text("0123456789.,;\n\t-eE xVs", max_size=200).map(str.encode))
def test_anything_is_read_or_refused(content: bytes) -> None:
    try:
        table = read_table(content)
    except UsageError:
        return
    assert len(table.time_s) >= 2
    assert np.all(np.diff(table.time_s) > 0)
    assert table.columns.shape == (len(table.names), len(table.time_s))
